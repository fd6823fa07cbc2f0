struct RayPayloadType { vec3 color; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float infinity = uintBitsToFloat(0x7F800000u);  // tmax may be infinite
  bool border = max(abs(ndc.x), abs(ndc.y)) > 0.9;
  // An interval of length 0 at the border of the image: no ray.
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.0, normalize(vec3(ndc, -2)), border ? 0.0 : infinity, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(0.9, 0.5, 0.1); }
void main() { /**** MISS SHADER ****/ payload.color = vec3(0.1); }
