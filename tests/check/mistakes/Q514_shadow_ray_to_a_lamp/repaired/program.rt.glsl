struct RayPayloadType {
  vec3 radiance;
  bool visible;
};

const vec3 lamp = vec3(2.0, 6.0, 3.0);

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 1.0, 6.0), 0.001,
              normalize(vec3(ndc, -2.0)), 1000.0, 0);
  gsnSetPixel(vec4(payload.radiance, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 here = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  vec3 toLamp = lamp - here;
  float dist = length(toLamp);
  payload.visible = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u,
              here, 0.001, toLamp / dist, dist, 0);
  payload.radiance = payload.visible ? vec3(8.0 / (dist * dist)) : vec3(0.02);
}

void main() { /**** MISS SHADER ****/
  payload.radiance = vec3(0.3);
  payload.visible = true;
}
