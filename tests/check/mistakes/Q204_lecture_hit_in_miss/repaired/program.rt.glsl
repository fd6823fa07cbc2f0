/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
  float t;  // negative if the ray hit nothing
};
struct HitAttributeType {
  vec3 normal;
};
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 point = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 direction = normalize(vec3(point, -2.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 6.0), 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.t > 0.0 ? payload.color : vec3(0.3, 0.5, 0.9), 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 o = gl_ObjectRayOriginEXT;
  vec3 d = gl_ObjectRayDirectionEXT;
  float a = dot(d, d);
  float b = dot(o, d);
  float h = b * b - a * (dot(o, o) - 1.0);
  if (h < 0.0) return;
  float t = (-b - sqrt(h)) / a;
  if (t < gl_RayTminEXT || t >= gl_RayTmaxEXT) return;
  hit.normal = o + t * d;
  reportIntersectionEXT(t, 1u);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 normal = normalize(vec3(hit.normal * gl_WorldToObjectEXT));
  payload.color = 0.5 + 0.5 * normal;
  payload.t = gl_HitTEXT;
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
  payload.t = -1.0;
}
