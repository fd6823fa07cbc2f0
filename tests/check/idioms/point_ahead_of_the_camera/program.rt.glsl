// Normalized and plain directions in one shader: the point at a fixed distance is not a hit.
struct RayPayloadType { float t; };

uniform float focus;  // defaultval="4" min="0.1" max="100" unit="m"

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 eye = vec3(0, 0, 6), dir = vec3(ndc, -2.0);
  vec3 focused = eye + focus * normalize(dir);
  vec3 lens = eye + vec3(0.02, 0.0, 0.0);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, lens, 0.001, focused - lens, 1e3, 0);
  vec3 position = lens + payload.t * (focused - lens);
  gsnSetPixel(vec4(payload.t < 0.0 ? vec3(0.0) : fract(position), 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.t = gl_HitTEXT; }
void main() { /**** MISS SHADER ****/ payload.t = -1.0; }
