struct RayPayloadType { vec3 color; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, gl_RayFlagsNoOpaqueEXT, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

bool hole(vec2 b) { return fract(6.0 * b.x) + fract(6.0 * b.y) > 1.2; }

void main() { /**** ANY-HIT SHADER ****/
  if (hole(baryCoord)) {
    ignoreIntersectionEXT;
  } else if (gl_PrimitiveID == 0) {
    terminateRayEXT;
  }
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(1.0, 0.5, 0.1); }
void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
