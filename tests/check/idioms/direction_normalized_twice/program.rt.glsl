// All rays have unit directions, so normalize() in the closest-hit shader changes nothing.
struct RayPayloadType { vec3 color; bool lit; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 d = vec3(ndc, -2.0);
  d /= length(d);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, d, 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 here = gl_WorldRayOriginEXT + normalize(gl_WorldRayDirectionEXT) * gl_HitTEXT;
  vec3 away = -gl_WorldRayDirectionEXT;
  vec3 reflected = 2.0 * dot(away, vec3(0, 1, 0)) * vec3(0, 1, 0) - away;
  payload.lit = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u,
              here, 0.001, reflected, 1e3, 0);
  payload.color = payload.lit ? vec3(0.9) : vec3(0.3);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.4);
  payload.lit = true;
}
