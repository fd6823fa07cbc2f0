/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
uniform bool objectSpace;  // defaultval="true" help="Pattern in object space"
struct Frame2 { vec3 origin; vec3 direction; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

Frame2 ray() {
  if (objectSpace) return Frame2(gl_ObjectRayOriginEXT, gl_ObjectRayDirectionEXT);
  return Frame2(gl_WorldRayOriginEXT, gl_WorldRayDirectionEXT);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  Frame2 r = ray();
  vec3 p = r.origin + gl_HitTEXT * r.direction;
  vec3 world = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  float fog = exp(-0.05 * distance(world, gl_WorldRayOriginEXT));
  payload.color = fog * step(0.5, fract(3.0 * p));
}

void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
