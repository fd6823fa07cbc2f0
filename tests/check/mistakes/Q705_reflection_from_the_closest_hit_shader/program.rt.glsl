// gsnShaderOptions: precompiler="GL_EXT_ray_tracing, recursion: 2, app: 1"
/**** COMMON START ****/
struct RayPayloadType { vec3 color; int level; };
uniform float startOffset;  // defaultval="0.0" min="0" max="1" unit="m"
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload.level = 0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(0.1);
  if (payload.level == 1) return;
  payload.level = 1;
  vec3 from = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  vec3 to = reflect(gl_WorldRayDirectionEXT, vec3(0.0, 0.0, 1.0));
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, from, startOffset, to, 1e3, 0);  // EXPECT Q705
}

void main() { /**** MISS SHADER ****/ payload.color = vec3(0.5, 0.7, 0.9); }
