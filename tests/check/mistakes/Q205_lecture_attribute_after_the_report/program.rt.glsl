/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};
struct HitAttributeType {
  vec3 normal;
};
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 point = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 direction = normalize(vec3(point, -2.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 6.0), 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 o = gl_ObjectRayOriginEXT;
  vec3 d = gl_ObjectRayDirectionEXT;
  float b = dot(o, d);
  float discriminant = b * b - dot(d, d) * (dot(o, o) - 1.0);
  if (discriminant < 0.0) return;
  float t = (-b - sqrt(discriminant)) / dot(d, d);
  reportIntersectionEXT(t, 0u);
  hit.normal = o + t * d;
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = 0.5 + 0.5 * hit.normal;  // EXPECT Q205
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
