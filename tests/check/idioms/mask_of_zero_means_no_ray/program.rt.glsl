struct RayPayloadType { vec3 color; float light; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  // All invocations trace; those that face away from the light use an empty mask.
  vec3 p0, p1, p2;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p0, p1, p2);
  vec3 n = normalize(vec3(cross(p1 - p0, p2 - p0) * gl_WorldToObjectEXT));
  vec3 toSun = normalize(vec3(1.0, 2.0, 1.0));
  float cosine = dot(n, toSun);
  uint mask = cosine > 0.0 ? 0xFFu : 0u;
  payload.light = 0.0;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, mask, 0u, 0u, 0u,
              gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT, 0.001, toSun, 1e3, 0);
  payload.color = vec3(0.05) + max(cosine, 0.0) * payload.light;
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.3);
  payload.light = 1.0;
}
