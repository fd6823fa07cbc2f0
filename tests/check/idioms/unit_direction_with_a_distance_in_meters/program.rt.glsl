// The closest-hit shader converts t to meters, so the position needs the unit direction.
struct RayPayloadType { float meters; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 eye = vec3(0, 0, 6), dir = vec3(ndc, -2.0);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, eye, 0.001, dir, 1e3, 0);
  vec3 position = eye + payload.meters * normalize(dir);
  gsnSetPixel(vec4(payload.meters < 0.0 ? vec3(0.0) : fract(position), 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.meters = gl_HitTEXT * length(gl_WorldRayDirectionEXT); }
void main() { /**** MISS SHADER ****/ payload.meters = -1.0; }
