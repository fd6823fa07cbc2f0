struct RayPayloadType {
  vec3 color;
  bool lit;
};

void main() { /**** RAY GENERATION SHADER ****/
  vec2 p = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 1, 6), 1e-3, normalize(vec3(p, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p0, p1, p2;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p0, p1, p2);
  vec3 P = p0 + baryCoord.x * (p1 - p0) + baryCoord.y * (p2 - p0);
  P = gl_ObjectToWorldEXT * vec4(P, 1.0);
  payload.lit = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u, P,
              0.01, normalize(vec3(0.5, 1.0, 0.25)), 1e3, 0);
  payload.color = payload.lit ? vec3(0.8) : vec3(0.1);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.5, 0.6, 0.8);
  payload.lit = true;
}
