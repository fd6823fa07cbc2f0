struct RayPayloadType { vec3 color; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 uv = vec2(gl_LaunchIDEXT.xy / gl_LaunchSizeEXT.xy);  // EXPECT Q716
  vec3 direction = normalize(vec3(2.0 * uv - 1.0, -2.0));
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, direction, 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(0.2, 0.5, 0.1);
}

void main() { /**** MISS SHADER ****/
  payload.color = 0.5 + 0.5 * gl_WorldRayDirectionEXT;
}
