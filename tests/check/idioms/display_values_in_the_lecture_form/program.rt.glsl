// The lecture form writes display values, so a linear color is encoded here.
struct RayPayloadType { vec3 linear; };

vec3 encode(vec3 c) {
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(encode(payload.linear), 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.linear = vec3(0.18); }
void main() { /**** MISS SHADER ****/ payload.linear = vec3(0.5, 0.7, 1.0); }
