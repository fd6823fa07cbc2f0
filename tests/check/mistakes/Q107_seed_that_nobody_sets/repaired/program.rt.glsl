/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
  uint rng;
};

float rnd(inout uint state) {
  state = state * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
  return float((word >> 22) ^ word) / 4294967296.0;
}
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 p = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload.rng = gl_LaunchIDEXT.x + 4096u * gl_LaunchIDEXT.y;
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 6.0), 0.001, normalize(vec3(p, -2.0)),
              1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  float noise = rnd(payload.rng);
  payload.color = vec3(0.5 + 0.2 * noise);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
