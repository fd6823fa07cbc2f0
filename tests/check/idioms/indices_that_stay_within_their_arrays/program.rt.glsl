struct RayPayloadType { vec3 color; };
const float kernel[8] = float[](1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125, 0.015625, 0.0078125);

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  float sum = 0.0;
  for (uint i = 8u; i-- > 0u;) sum += kernel[i];
  int last = gl_PrimitiveID;
  while (last >= kernel.length()) last -= 8;
  sum -= kernel[last & 7] + kernel[clamp(gl_InstanceID - 4, 0, 7)] + kernel[(gl_InstanceID + 1) % 8];
  for (int i = 0; i <= 8; ++i) {
    if (i == 8) break;
    sum += 0.01 * kernel[i];
  }
  payload.color = vec3(sum);
}

void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
