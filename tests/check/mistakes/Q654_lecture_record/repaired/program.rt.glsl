/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
  float t;  // negative if the ray hit nothing
};
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 point = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 direction = normalize(vec3(point, -2.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 6.0), 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.t > 0.0 ? payload.color : vec3(0.3, 0.5, 0.9), 1.0));
}

uniform vec3 tint;  // defaultval="1.0, 1.0, 1.0"

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = tint;
  payload.t = gl_HitTEXT;
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
  payload.t = -1.0;
}
