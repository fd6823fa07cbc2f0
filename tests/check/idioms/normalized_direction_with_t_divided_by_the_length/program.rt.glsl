/**** COMMON START ****/
struct RayPayloadType { vec3 c; };
struct HitAttributeType { vec3 n; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 q = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 5), 0.001, normalize(vec3(q, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.c, 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  float len = length(gl_ObjectRayDirectionEXT);
  vec3 unit = gl_ObjectRayDirectionEXT / len;
  float b = dot(gl_ObjectRayOriginEXT, unit);
  float h = b * b - dot(gl_ObjectRayOriginEXT, gl_ObjectRayOriginEXT) + 0.2;
  if (h < 0.0) return;
  float meters = -b - sqrt(h);  // in object space
  hit.n = gl_ObjectRayOriginEXT + meters * unit;
  reportIntersectionEXT(meters / len, 0u);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.c = 0.5 + 0.5 * normalize(vec3(hit.n * gl_WorldToObjectEXT));
}

void main() { /**** MISS SHADER ****/
  payload.c = vec3(0.0);
}
