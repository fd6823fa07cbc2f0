struct RayPayloadType { float bins[6]; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < payload.bins.length(); ++i) sum += payload.bins[i] * vec3(i == 0, i == 2, i == 5);
  gsnSetPixel(vec4(sum, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  for (int i = 0; i < 6; ++i) payload.bins[i] = exp(-0.2 * float(i) * gl_HitTEXT);
}

void main() { /**** MISS SHADER ****/
  for (int i = 6; i-- > 0;) payload.bins[i] = 0.1;
}
