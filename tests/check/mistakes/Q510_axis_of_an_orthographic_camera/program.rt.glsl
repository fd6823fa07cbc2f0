struct RayPayloadType {
  vec3 col;
};

// Orthographic camera; the axis was meant to become a uniform.
const vec3 viewAxis = vec3(0.0);

void main() { /**** RAY GENERATION SHADER ****/
  vec2 p = (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy);
  vec3 start = vec3(4.0 * p - 2.0, 10.0);
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, start, 0.0, viewAxis, 100.0, 0);  // EXPECT Q510
  gsnSetPixel(vec4(payload.col, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.col = vec3(0.8, 0.6, 0.2) / (1.0 + 0.1 * gl_HitTEXT);
}

void main() { /**** MISS SHADER ****/
  payload.col = vec3(0.05);
}
