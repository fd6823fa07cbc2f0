/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
struct HitAttributeType { vec3 n; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

bool candidate(float t, float tmax, uint kind) {
  if (t < gl_RayTminEXT || t > tmax) return false;
  hit.n = (gl_ObjectRayOriginEXT + t * gl_ObjectRayDirectionEXT) * (kind == 0u ? 1.0 : -1.0);
  return reportIntersectionEXT(t, kind);
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 o = gl_ObjectRayOriginEXT, d = gl_ObjectRayDirectionEXT;
  float a = dot(d, d), b = dot(o, d), h = b * b - a * (dot(o, o) - 0.3);
  if (h < 0.0) return;
  float tmax = gl_RayTmaxEXT;
  if (!candidate((-b - sqrt(h)) / a, tmax, 0u)) candidate((-b + sqrt(h)) / a, tmax, 1u);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = 0.5 + 0.5 * normalize(hit.n);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
