struct RayPayloadType { vec3 color; float t; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 direction = normalize(vec3(ndc, -2));
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 3; ++i) {
    // The ray of the first iteration starts at the camera, each other one behind the hit before.
    float start = i > 0 ? payload.t + 0.01 : 0.0;
    traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), start, direction, 1e3, 0);
    sum += payload.color / float(i + 1);
    if (payload.t > 900.0) break;
  }
  gsnSetPixel(vec4(sum, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(0.1, 0.2, 0.3);
  payload.t = gl_HitTEXT;
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.2);
  payload.t = 999.0;
}
