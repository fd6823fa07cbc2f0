struct RayPayloadType { vec3 color; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 eye = vec3(0.0, 1.0, 6.0);
  vec3 d = normalize(vec3(ndc, -2.0));
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, eye, 0.001, d, 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(1.0);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
