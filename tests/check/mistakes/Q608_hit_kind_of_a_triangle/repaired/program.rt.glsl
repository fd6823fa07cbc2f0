/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 p = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 5), 0.001, normalize(vec3(p, -2.0)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  // Disk in the plane z = 0.
  float t = -gl_ObjectRayOriginEXT.z / gl_ObjectRayDirectionEXT.z;
  vec3 q = gl_ObjectRayOriginEXT + t * gl_ObjectRayDirectionEXT;
  if (dot(q.xy, q.xy) > 0.2) return;
  uint kind = gl_ObjectRayDirectionEXT.z < 0.0 ? 0u : 1u;
  reportIntersectionEXT(t, kind);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = (gl_HitKindEXT & 1u) == 0u ? vec3(1.0, 0.5, 0.0) : vec3(0.0, 0.5, 1.0);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
