// Writes the payload on some paths and ignores every intersection: the result is in the payload, not in a hit.
struct RayPayloadType { float farthest; float alpha; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload.farthest = 0.0;
  payload.alpha = 0.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(vec3(payload.farthest / 10.0), payload.alpha));
}

void main() { /**** ANY-HIT SHADER ****/
  if (gl_HitTEXT > payload.farthest) {
    payload.farthest = gl_HitTEXT;
    payload.alpha = 1.0;
  }
  ignoreIntersectionEXT;
}
