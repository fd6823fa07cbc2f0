/**** COMMON START ****/
struct RayPayloadType { float d; };
struct HitAttributeType { vec3 p; };
struct LocalRay { vec3 o; vec3 d; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(vec3(exp(-payload.d)), 1.0));
}

LocalRay localRay() {
  return LocalRay(gl_ObjectRayOriginEXT, gl_ObjectRayDirectionEXT);
}

float plane(LocalRay r, float height) { return (height - r.o.y) / r.d.y; }

void main() { /**** INTERSECTION SHADER ****/
  LocalRay r = localRay();
  float t = plane(r, 0.1);
  hit.p = r.o + t * r.d;
  if (max(abs(hit.p.x), abs(hit.p.z)) > 0.5) return;
  reportIntersectionEXT(t, 0u);
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.d = length(hit.p); }
void main() { /**** MISS SHADER ****/ payload.d = 100.0; }
