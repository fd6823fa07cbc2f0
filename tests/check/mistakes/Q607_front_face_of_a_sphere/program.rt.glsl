/**** COMMON START ****/
struct RayPayloadType { vec3 couleur; };
struct HitAttributeType { vec3 normale; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 point = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 5), 0.001, normalize(vec3(point, -2.0)), 1e3, 0);
  gsnSetPixel(vec4(payload.couleur, 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 o = gl_ObjectRayOriginEXT;
  vec3 d = gl_ObjectRayDirectionEXT;
  float a = dot(d, d);
  float b = dot(o, d);
  float delta = b * b - a * (dot(o, o) - 0.2);
  if (delta <= 0.0) return;
  float racine = sqrt(delta);
  hit.normale = o + (-b - racine) / a * d;
  reportIntersectionEXT((-b - racine) / a, 1u);
  hit.normale = o + (-b + racine) / a * d;
  reportIntersectionEXT((-b + racine) / a, 2u);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  bool dehors = gl_HitKindEXT == gl_HitKindFrontFacingTriangleEXT;  // EXPECT Q607
  vec3 n = normalize(hit.normale) * (dehors ? 1.0 : -1.0);
  payload.couleur = 0.5 + 0.5 * n;
}

void main() { /**** MISS SHADER ****/
  payload.couleur = vec3(0.0);
}
