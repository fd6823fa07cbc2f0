struct RayPayloadType { vec3 color; };
const float near = 0.5;
const float maxDistance = min(near, 0.1);

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float start = near;
  if (ndc.x > 0.0) start += 0.5;
  // EXPECT+1 Q509
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), start, normalize(vec3(ndc, -2)), maxDistance, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(1.0); }
void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
