// gsnShaderOptions: precompiler="GL_EXT_ray_tracing, recursion: 3, app: 1"
/**** COMMON START ****/
struct RayPayloadType {
  vec3 radiance;
  vec3 throughput;
  int depth;
};
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload.throughput = vec3(1.0);
  payload.depth = 0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.radiance, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 albedo = vec3(0.7, 0.6, 0.5);
  vec3 emitted = vec3(0.05);
  payload.throughput = gl_HitTEXT * albedo;
  vec3 mine = payload.throughput;
  payload.radiance = vec3(0.0);
  if (payload.depth >= 2) return;
  payload.depth++;
  vec3 p = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  // EXPECT+1 Q105
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, p, 0.001, reflect(gl_WorldRayDirectionEXT, vec3(0, 1, 0)), 1e3, 0);
  payload.radiance = emitted + payload.throughput * payload.radiance;
}

void main() { /**** MISS SHADER ****/
  payload.radiance = vec3(0.6, 0.7, 0.9);
  payload.throughput = vec3(1.0);
}
