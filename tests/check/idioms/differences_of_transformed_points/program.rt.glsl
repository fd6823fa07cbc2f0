struct RayPayloadType { vec3 color; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  // Two points in object space; their difference is the direction of the ray in object space.
  vec3 a = gl_WorldToObjectEXT * vec4(gl_WorldRayOriginEXT, 1.0);
  vec3 b = gl_WorldToObjectEXT * vec4(gl_WorldRayOriginEXT + gl_WorldRayDirectionEXT, 1.0);
  vec3 d = normalize(b - a);
  vec4 plane = vec4(0.0, 1.0, 0.0, -0.25);
  float height = dot(plane, vec4(a + gl_HitTEXT * gl_ObjectRayDirectionEXT, 1.0));
  // The length of a column of the matrix is the scale along the axis.
  float scale = length(gl_ObjectToWorldEXT[0]);
  payload.color = abs(d) * fract(4.0 * scale * height);
}

void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
