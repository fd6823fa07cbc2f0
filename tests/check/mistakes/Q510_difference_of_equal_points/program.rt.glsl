struct RayPayloadType { float seen; };

const vec3 lampPosition = vec3(1.0, 4.0, 2.0);

vec3 cameraDirection() {
  vec2 q = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  return normalize(vec3(q, -2.0));
}

void main() { /**** RAY GENERATION SHADER ****/
  vec3 eye = vec3(0.0, 0.0, 7.0);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, eye, 0.01, cameraDirection(), 50.0, 0);
  float first = payload.seen;
  vec3 start = lampPosition;
  vec3 toLamp = lampPosition - start;
  // EXPECT+1 Q510
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, start, 0.01, toLamp, 1.0, 0);
  gsnSetPixel(vec4(vec3(first), 1.0) * (0.5 + 0.5 * payload.seen));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.seen = 0.0;
}

void main() { /**** MISS SHADER ****/
  payload.seen = 1.0;
}
