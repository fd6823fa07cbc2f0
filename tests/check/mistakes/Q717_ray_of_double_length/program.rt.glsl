struct RayPayloadType { float t; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 eye = vec3(0, 0, 6), dir = normalize(vec3(ndc, -2));
  float longest = 500.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, eye, 0.0, longest * dir, 1.0, 0);
  vec3 position = eye + payload.t * dir;  // EXPECT Q717
  gsnSetPixel(vec4(payload.t < 0.0 ? vec3(0.0) : fract(position), 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.t = gl_HitTEXT; }
void main() { /**** MISS SHADER ****/ payload.t = -1.0; }
