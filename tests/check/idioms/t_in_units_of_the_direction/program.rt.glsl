// The primary direction is not normalized, so that t is the depth along the axis of the camera.
struct RayPayloadType { float depth; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 plane = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 direction = vec3(0.5 * plane, -1.0);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.01, direction, 50.0, 0);
  float range = payload.depth * length(direction);
  gsnSetPixel(vec4(vec3(1.0 / (1.0 + range)), 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.depth = gl_HitTEXT; }
void main() { /**** MISS SHADER ****/ payload.depth = 50.0; }
