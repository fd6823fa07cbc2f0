// Each frame replaces the one before, so fixed noise is a choice.
struct RayPayloadType { vec3 color; };

float noise(vec2 p) { return fract(sin(dot(p, vec2(12.9898, 78.233))) * 43758.5453); }

void main() { /**** RAY GENERATION SHADER ****/
  vec2 p = vec2(gl_LaunchIDEXT.xy);
  vec2 ndc = 2.0 * (p + vec2(noise(p), noise(p + 17.0))) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(baryCoord, 0.5); }
void main() { /**** MISS SHADER ****/ payload.color = vec3(0.05); }
