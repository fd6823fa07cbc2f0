// All rays skip the closest-hit shader: the payload says "hit" unless the miss shader runs.
struct RayPayloadType { vec3 sky; bool missed; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload.missed = false;
  payload.sky = vec3(0.0);
  traceRayEXT(topLevelAS, gl_RayFlagsSkipClosestHitShaderEXT | gl_RayFlagsTerminateOnFirstHitEXT, 0xFFu, 0u, 0u, 0u,
              vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.missed ? payload.sky : vec3(0.1), 1.0));
}

void main() { /**** MISS SHADER ****/
  float h = gl_WorldRayDirectionEXT.y;
  payload.sky = exp(-4.0 * abs(h)) * vec3(1.0, 0.8, 0.6) + vec3(0.2, 0.4, 0.8) * max(h, 0.0);
  payload.missed = true;
}
