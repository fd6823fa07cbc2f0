/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
// A collection of helpers; this program needs only one of them.
vec3 worldFromObject(vec3 p) { return gl_ObjectToWorldEXT * vec4(p, 1.0); }
vec3 hitPoint() { return gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT; }
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = fract(hitPoint());
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
