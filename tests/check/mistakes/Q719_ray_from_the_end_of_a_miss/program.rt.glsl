// gsnShaderOptions: precompiler="GL_EXT_ray_tracing, recursion: 2, app: 1"
struct RayPayloadType { vec3 color; int depth; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload.depth = 0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(baryCoord, 0.5); }

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.3, 0.5, 0.8);
  if (payload.depth == 1) return;
  payload.depth = 1;
  vec3 position = gl_WorldRayOriginEXT + gl_RayTmaxEXT * gl_WorldRayDirectionEXT;
  vec3 up = vec3(0.0, 1.0, 0.0);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, position, 0.001, up, 1000.0, 0);  // EXPECT Q719
}
