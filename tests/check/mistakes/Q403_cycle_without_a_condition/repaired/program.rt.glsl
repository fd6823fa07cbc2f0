// gsnShaderOptions: precompiler="GL_EXT_ray_tracing, recursion: 4, app: 1"
struct RayPayloadType {
  vec3 color;
  int bounces;
};

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload.bounces = 0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 1, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  vec3 r = reflect(gl_WorldRayDirectionEXT, vec3(0.0, 1.0, 0.0));
  payload.color = vec3(0.0);
  if (++payload.bounces > 3) return;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, p, 0.001, r, 1e3, 0);
  payload.color = 0.8 * payload.color + vec3(0.05);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.5, 0.7, 1.0);
}
