/**** COMMON START ****/
struct RayPayloadType { bool hit; };
#define HIT_POINT (gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT)
// Helpers of a larger program; this one has no closest-hit shader.
float checkers(vec3 p) { return mod(floor(p.x) + floor(p.z), 2.0); }
float floorColor() { return checkers(HIT_POINT); }
void pass() { ignoreIntersectionEXT; }
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload.hit = true;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.hit ? 1.0 : checkers(vec3(8.0 * ndc, 0.0).xzy)));
}

void main() { /**** MISS SHADER ****/
  payload.hit = false;
}
