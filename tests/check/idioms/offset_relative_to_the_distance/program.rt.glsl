struct RayPayloadType { vec3 color; bool lit; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  // Steps back along the ray by a part of the distance, so tmin can be 0.
  vec3 p = gl_WorldRayOriginEXT + 0.9999 * gl_HitTEXT * gl_WorldRayDirectionEXT;
  float near = max(1e-4, 1e-5 * gl_HitTEXT);
  payload.lit = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u, p, near,
              normalize(vec3(1, 3, 2)), 1e3, 0);
  payload.color = payload.lit ? vec3(0.8) : vec3(0.1);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.5);
  payload.lit = true;
}
