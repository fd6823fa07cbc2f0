/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
struct HitAttributeType {
  vec3 normal;
  vec2 texCoord;
};
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 o = gl_ObjectRayOriginEXT, d = gl_ObjectRayDirectionEXT;
  float a = dot(d, d), b = dot(o, d), c = dot(o, o) - 0.25;
  float h = b * b - a * c;
  if (h < 0.0) return;
  float t = (-b - sqrt(h)) / a;
  hit.normal = normalize(o + t * d);
  hit.texCoord = vec2(atan(hit.normal.z, hit.normal.x), asin(hit.normal.y));
  reportIntersectionEXT(t, 0u);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec2 stripes = step(0.5, fract(8.0 * hit.texCoord));
  payload.color = vec3(stripes, 0.2) * (0.6 + 0.4 * hit.normal.y);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.02);
}
