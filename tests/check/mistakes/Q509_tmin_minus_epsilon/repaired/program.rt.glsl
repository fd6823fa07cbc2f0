/**** COMMON START ****/
struct RayPayloadType {
  vec3 radianz;
};
#define EPSILON 1e-4
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 punkt = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 auge = vec3(0.0, 0.0, 6.0);
  vec3 richtung = normalize(vec3(punkt, -2.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, auge, EPSILON, richtung, 1e4, 0);
  gsnSetPixel(vec4(payload.radianz, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.radianz = vec3(fract(gl_HitTEXT));
}

void main() { /**** MISS SHADER ****/
  payload.radianz = vec3(0.0, 0.1, 0.3);
}
