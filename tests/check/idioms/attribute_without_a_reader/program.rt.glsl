/**** COMMON START ****/
struct RayPayloadType { float t; };
struct HitAttributeType { vec3 normal; vec2 uv; uint face; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(vec3(1.0 / payload.t), 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 lo, hi;
  gsnGetIntersectionBox(gl_InstanceID, gl_PrimitiveID, lo, hi);
  vec3 u = (lo - gl_ObjectRayOriginEXT) / gl_ObjectRayDirectionEXT;
  vec3 v = (hi - gl_ObjectRayOriginEXT) / gl_ObjectRayDirectionEXT;
  vec3 a = min(u, v), b = max(u, v);
  float t = max(a.x, max(a.y, a.z));
  if (t > min(b.x, min(b.y, b.z))) return;
  // Only the face is used below; normal and uv are for a later version.
  hit.face = t == a.x ? 0u : t == a.y ? 1u : 2u;
  reportIntersectionEXT(t, hit.face);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.t = gl_HitTEXT * (1.0 + float(hit.face));
}

void main() { /**** MISS SHADER ****/
  payload.t = 1e3;
}
