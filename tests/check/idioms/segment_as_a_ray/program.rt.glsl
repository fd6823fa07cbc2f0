// The direction is the vector to the lamp, and tmax is 1: the lamp is at t = 1. No normalization is needed.
struct RayPayloadType { vec3 color; bool visible; };
const vec3 lamp = vec3(0.0, 5.0, 2.0);

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  vec3 segment = lamp - p;
  payload.visible = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u, p,
              0.001, segment, 0.999, 0);
  payload.color = payload.visible ? vec3(20.0 / dot(segment, segment)) : vec3(0.0);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.1);
  payload.visible = true;
}
