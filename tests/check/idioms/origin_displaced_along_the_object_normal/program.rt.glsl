// A point is moved along the normal in object space, then the point is transformed to world space.
struct RayPayloadType {
  vec3 color;
  bool sky;
};

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p0, p1, p2;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p0, p1, p2);
  vec3 n = normalize(cross(p1 - p0, p2 - p0));
  vec3 p = gl_ObjectRayOriginEXT + gl_HitTEXT * gl_ObjectRayDirectionEXT;
  if (dot(n, gl_ObjectRayDirectionEXT) > 0.0) n = -n;
  vec3 start = gl_ObjectToWorldEXT * vec4(p + 0.001 * n, 1.0);
  payload.sky = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u, start,
              0.0, vec3(0.0, 1.0, 0.0), 100.0, 0);
  payload.color = payload.sky ? vec3(0.9) : vec3(0.2);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.3, 0.5, 0.8);
  payload.sky = true;
}
