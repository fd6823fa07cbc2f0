struct RayPayloadType {
  vec3 color;
  int layers;
};

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload.layers = 0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 1, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** ANY-HIT SHADER ****/
  // Cuts holes into the surface.
  float u = fract(10.0 * baryCoord.x);
  if (u > 0.0) ignoreIntersectionEXT;  // EXPECT Q606
  ignoreIntersectionEXT;
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(0.2, 0.9, 0.4);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.1);
}
