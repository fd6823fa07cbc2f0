// Absorption along a shadow ray: the miss shader knows the length of the ray, tmax.
struct RayPayloadType { vec3 color; float light; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 200.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 toLamp = vec3(2, 5, 3) - (gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT);
  float dist = length(toLamp);
  payload.light = 0.0;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u,
              vec3(2, 5, 3) - toLamp, 0.001, toLamp / dist, dist, 0);
  payload.color = vec3(0.1 + payload.light);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.2);
  payload.light = exp(-0.3 * gl_RayTmaxEXT);
}
