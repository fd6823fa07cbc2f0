// The difference of two world-space points is a world-space vector; for a uniformly scaled sphere it is the normal.
/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 o = gl_ObjectRayOriginEXT, d = gl_ObjectRayDirectionEXT;
  float a = dot(d, d), b = dot(o, d), h = b * b - a * (dot(o, o) - 0.3);
  if (h >= 0.0) reportIntersectionEXT((-b - sqrt(h)) / a, 7u);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 center = gl_ObjectToWorldEXT * vec4(0.0, 0.0, 0.0, 1.0);
  vec3 p = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  vec3 normal = normalize(p - center);
  payload.color = vec3(max(dot(normal, normalize(vec3(1, 1, 1))), 0.1));
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
