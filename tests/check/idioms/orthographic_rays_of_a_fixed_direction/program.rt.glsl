struct RayPayloadType { vec3 c; };
const vec3 axis = vec3(0.0, -1.0, 0.0);  // unit, along an axis

void main() { /**** RAY GENERATION SHADER ****/
  vec2 p = vec2(gl_LaunchIDEXT.xy) / vec2(gl_LaunchSizeEXT.xy - 1u);
  vec3 start = vec3(6.0 * p.x - 3.0, 20.0, 6.0 * p.y - 3.0);
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, start, 0.0, axis, 40.0, 0);
  gsnSetPixel(vec4(payload.c, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.c = vec3(1.0 - gl_HitTEXT / 40.0); }
void main() { /**** MISS SHADER ****/ payload.c = vec3(0.0); }
