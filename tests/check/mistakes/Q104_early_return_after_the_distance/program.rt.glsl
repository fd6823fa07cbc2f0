struct RayPayloadType { float distance; vec3 tint; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  // EXPECT+1 Q104
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 100.0, 0);
  vec3 c = payload.distance < 100.0 ? payload.tint / (1.0 + payload.distance) : vec3(0.2, 0.3, 0.5);
  gsnSetPixel(vec4(c, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.distance = gl_HitTEXT;
  if (gl_HitKindEXT == gl_HitKindBackFacingTriangleEXT) return;
  payload.tint = vec3(baryCoord, 0.5);
}

void main() { /**** MISS SHADER ****/
  payload.distance = 100.0;
}
