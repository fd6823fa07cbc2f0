struct RayPayloadType { vec3 color; };

vec3 transform(mat4x3 m, vec3 v, float w) { return m * vec4(v, w); }

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 local = gl_ObjectRayOriginEXT + gl_HitTEXT * gl_ObjectRayDirectionEXT;
  vec3 world = transform(gl_ObjectToWorldEXT, local, 1.0);
  vec3 axis = normalize(transform(gl_ObjectToWorldEXT, vec3(0.0, 1.0, 0.0), 0.0));
  vec3 view = transform(gl_ObjectToWorldEXT, gl_ObjectRayDirectionEXT, 0.0);
  payload.color = fract(2.0 * world) * (0.6 + 0.4 * axis.y) + 0.1 * floor(4.0 * view);
}

void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
