struct RayPayloadType { vec3 color; };

void main() { /**** RAY GENERATION SHADER ****/
  ivec2 size = ivec2(gl_LaunchSizeEXT.xy);
  ivec2 id = ivec2(gl_LaunchIDEXT.xy);
  vec2 st = vec2(id) / vec2(size);
  float aspect = float(size.x) / float(size.y);
  vec3 d = normalize(vec3((2.0 * st.x - 1.0) * aspect, 2.0 * st.y - 1.0, -2.0));
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, d, 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(baryCoord, 1.0); }
void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
