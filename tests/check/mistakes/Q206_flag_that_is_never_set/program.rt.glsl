struct RayPayloadType { vec3 c; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 q = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFF, 0, 0, 0, vec3(0, 0, 4), 0.01, normalize(vec3(q, -1.5)), 100.0, 0);
  gsnSetPixel(vec4(payload.c, 1));
}

const int kMaxSteps = 64;

float sdf(vec3 p) { return length(p) - 0.45; }

void main() { /**** INTERSECTION SHADER ****/  // EXPECT Q206
  // Sphere tracing inside of the box.
  float t = gl_RayTminEXT;
  float scale = length(gl_ObjectRayDirectionEXT);
  bool found = false;
  for (int i = 0; i < kMaxSteps; ++i) {
    float d = sdf(gl_ObjectRayOriginEXT + t * gl_ObjectRayDirectionEXT);
    if (d < 1e-3) break;
    t += d / scale;
    if (t > gl_RayTmaxEXT) break;
  }
  if (found) reportIntersectionEXT(t, 0u);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.c = vec3(1.0, 0.8, 0.2);
}

void main() { /**** MISS SHADER ****/
  payload.c = vec3(0.0, 0.1, 0.2);
}
