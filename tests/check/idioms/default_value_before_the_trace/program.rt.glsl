// The closest-hit shader sets a default, a nested trace can replace it, and the result is used afterwards.
// gsnShaderOptions: precompiler="GL_EXT_ray_tracing, recursion: 2, app: 1"
struct RayPayloadType {
  vec3 color;
  int depth;
};

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload.depth = 0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 reflected = vec3(0.2);
  payload.color = reflected;
  if (payload.depth == 0) {
    payload.depth = 1;
    vec3 p = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
    traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, p, 0.001, reflect(gl_WorldRayDirectionEXT, vec3(0, 1, 0)), 1e3, 0);
  }
  payload.color = 0.5 * payload.color + vec3(0.1);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.4, 0.6, 0.9);
}
