struct RayPayloadType {
  vec3 color;
  bool lit;
};

void main() { /**** RAY GENERATION SHADER ****/
  vec2 plane = (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) * 2.0 - 1.0;
  vec3 forward = normalize(vec3(-1.0, -0.2, -3.0));
  vec3 right = normalize(cross(forward, vec3(0, 1, 0)));
  vec3 up = cross(right, forward);
  vec3 d = forward + plane.x * right + plane.y * up;
  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT, 0xFFu, 0u, 0u, 0u, vec3(2, 2, 7), 0.01, d, 500.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 d = gl_WorldRayDirectionEXT;
  vec3 position = gl_WorldRayOriginEXT + d * gl_HitTEXT;
  payload.lit = false;
  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT | gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT,
              0xFFu, 0u, 0u, 0u, position, 0.01, normalize(vec3(1.0, 3.0, 2.0)), 500.0, 0);
  payload.color = payload.lit ? vec3(0.8) : vec3(0.2);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.5, 0.7, 0.9);
  payload.lit = true;
}
