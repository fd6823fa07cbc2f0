// gsnShaderOptions: precompiler="GL_EXT_ray_tracing, recursion: 2, app: 1"
// A mirror without a scene of its own: in a scene with one ball, a reflected ray never hits it again.
struct RayPayloadType { vec3 color; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  vec3 center = gl_ObjectToWorldEXT * vec4(0.0, 0.0, 0.0, 1.0);
  vec3 n = normalize(p - center);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, p, 0.001, reflect(gl_WorldRayDirectionEXT, n), 1e3, 0);
  payload.color *= vec3(0.95, 0.9, 0.8);
}

void main() { /**** MISS SHADER ****/
  payload.color = 0.5 + 0.5 * normalize(gl_WorldRayDirectionEXT);
}
