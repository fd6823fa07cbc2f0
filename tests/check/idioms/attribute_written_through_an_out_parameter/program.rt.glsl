/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
struct HitAttributeType { vec3 normal; float u; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

bool cylinder(out float t, out HitAttributeType a) {
  vec2 o = gl_ObjectRayOriginEXT.xz, d = gl_ObjectRayDirectionEXT.xz;
  float A = dot(d, d), B = dot(o, d), D = B * B - A * (dot(o, o) - 0.16);
  t = 0.0;
  a = HitAttributeType(vec3(0.0), 0.0);
  if (D < 0.0 || A == 0.0) return false;
  t = (-B - sqrt(D)) / A;
  vec3 p = gl_ObjectRayOriginEXT + t * gl_ObjectRayDirectionEXT;
  a.normal = vec3(p.x, 0.0, p.z) / 0.4;
  a.u = atan(p.z, p.x) / 6.2831853;
  return abs(p.y) < 0.5;
}

void main() { /**** INTERSECTION SHADER ****/
  float t;
  HitAttributeType found;
  if (cylinder(t, found)) {
    hit = found;
    reportIntersectionEXT(t, 0u);
  }
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = (0.5 + 0.5 * normalize(vec3(hit.normal * gl_WorldToObjectEXT))) * step(0.5, fract(10.0 * hit.u));
}

void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
