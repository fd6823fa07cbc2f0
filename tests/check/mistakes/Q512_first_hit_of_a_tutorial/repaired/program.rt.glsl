struct RayPayloadType {
  vec3 L;
  bool hitSomething;
};

vec3 shadeDiffuse(vec3 n, vec3 albedo) { return albedo * max(dot(n, normalize(vec3(1, 2, 3))), 0.05); }

void main() { /**** RAY GENERATION SHADER ****/
  vec2 pix = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 dir = normalize(vec3(pix, -2.0));
  // "First hit" sounds like the visible surface.
  uint flags = gl_RayFlagsOpaqueEXT;
  traceRayEXT(topLevelAS, flags, 0xFFu, 0u, 0u, 0u, vec3(0.0, 1.0, 6.0), 0.001, dir, 1000.0, 0);
  gsnSetPixel(vec4(payload.hitSomething ? payload.L : vec3(0.0), 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p0, p1, p2;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p0, p1, p2);
  mat3 N;
  gsnGetNormal3x3Matrix(gl_InstanceID, N);
  payload.L = shadeDiffuse(normalize(N * cross(p1 - p0, p2 - p0)), vec3(0.7));
  payload.hitSomething = true;
}

void main() { /**** MISS SHADER ****/
  payload.L = vec3(0.0);
  payload.hitSomething = false;
}
