struct RayPayloadType { vec3 color; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  if (abs(ndc.x) > 0.95) { gsnSetPixel(vec4(0.0, 0.0, 0.0, 1.0)); return; }
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(0.1);
  if (gl_HitKindEXT == gl_HitKindBackFacingTriangleEXT) return;
  payload.color = vec3(0.8);
  if (gl_PrimitiveID == 0) { payload.color = vec3(1.0, 0.0, 0.0); return; }
}

void main() { /**** MISS SHADER ****/
  if (gl_WorldRayDirectionEXT.y < 0.0) { payload.color = vec3(0.2); return; }
  payload.color = vec3(0.4, 0.5, 0.7);
}
