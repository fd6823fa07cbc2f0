struct RayPayloadType { vec3 color; };
#define LAYER(n) (1u << (n))

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  uint layers = LAYER(0) | LAYER(9);
  // EXPECT+1 Q505
  traceRayEXT(topLevelAS, 0u, layers, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(1.0);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
