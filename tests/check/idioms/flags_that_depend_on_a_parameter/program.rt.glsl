struct RayPayloadType { vec3 color; };
uniform bool cull;      // defaultval="true"
uniform int layer;      // defaultval="0" min="0" max="7"
uniform float epsilon;  // defaultval="0.001" min="0" max="1" unit="m"

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  uint flags = gl_RayFlagsOpaqueEXT | (cull ? gl_RayFlagsCullBackFacingTrianglesEXT : gl_RayFlagsCullFrontFacingTrianglesEXT);
  uint mask = layer == 0 ? 0xFFu : 1u << layer;
  traceRayEXT(topLevelAS, flags, mask, 0u, 0u, 0u, vec3(0, 0, 6), epsilon, normalize(vec3(ndc, -2)), 1e3 + epsilon, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(0.7, 0.6, 0.5); }
void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
