/**** COMMON START ****/
struct RayPayloadType {
  vec3 value;
};
// Categories of instances.
#define LAYER_DIFFUSE 1u
#define LAYER_GLASS   2u
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 s = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  uint visible = LAYER_DIFFUSE | LAYER_GLASS;
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, visible, 0u, 0u, 0u, vec3(0.0, 0.0, 8.0), 0.0, normalize(vec3(s, -2.0)),
              100.0, 0);
  gsnSetPixel(vec4(payload.value, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.value = gl_InstanceCustomIndexEXT == 0 ? vec3(0.9) : vec3(0.3, 0.6, 0.9);
}

void main() { /**** MISS SHADER ****/
  payload.value = vec3(0.1);
}
