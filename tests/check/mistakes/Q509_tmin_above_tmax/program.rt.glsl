// A first ray, after a tutorial with other units (millimeters).
struct RayPayloadType {
  vec3 color;
};

const float nearPlane = 100.0;
const float farPlane = 10.0;

void main() { /**** RAY GENERATION SHADER ****/
  vec2 uv = (vec2(gl_LaunchIDEXT.xy) + vec2(0.5)) / vec2(gl_LaunchSizeEXT.xy);
  vec3 dir = normalize(vec3(uv * 2.0 - 1.0, -1.5));
  // EXPECT+1 Q509
  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 1.0, 200.0), nearPlane, dir, farPlane, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(1.0 - baryCoord.x - baryCoord.y, baryCoord);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.2);
}
