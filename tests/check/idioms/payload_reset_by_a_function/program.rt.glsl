// gsnShaderOptions: precompiler="GL_EXT_ray_tracing, recursion: 3, app: 1"
/**** COMMON START ****/
struct RayPayloadType { vec3 sum; float weight; int depth; };
/**** COMMON END ****/

void reset(out RayPayloadType p) {
  p.sum.r = 0.0;
  p.sum.gb = vec2(0.0);
  p.weight = 1.0;
  p.depth = 0;
}

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  reset(payload);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.sum, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.sum += payload.weight * vec3(0.05);
  payload.weight *= 0.5;
  payload.depth += 1;
  if (payload.depth >= 3) return;
  vec3 x = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, x, 0.001, reflect(gl_WorldRayDirectionEXT, vec3(0, 0, 1)), 1e3, 0);
}

void main() { /**** MISS SHADER ****/
  payload.sum += payload.weight * vec3(0.4, 0.6, 0.9);
}
