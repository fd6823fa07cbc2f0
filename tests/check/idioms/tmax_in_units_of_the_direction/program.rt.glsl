struct RayPayloadType { vec3 color; bool open; };
const vec3 lamp = vec3(1.0, 4.0, 1.0);

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, vec3(ndc, -2.0), 1e30, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 x = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  vec3 d = 3.0 * normalize(lamp - x);
  payload.open = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u, x, 0.001,
              d, distance(x, lamp) / length(d), 0);
  payload.color = payload.open ? vec3(1.0) : vec3(0.1);
}

void main() { /**** MISS SHADER ****/ payload.color = vec3(0.2); payload.open = true; }
