struct RayPayloadType { vec3 color; };
const vec3 up = vec3(0.0, 1.0, 0.0);
const vec3 forward = vec3(0.0, 0.0, -1.0);

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  // Look along the right side of the camera.
  vec3 right = cross(forward, up);
  vec3 start = vec3(-8.0, 2.0 * ndc.y, 2.0 * ndc.x);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, start, 0.001, right, 100.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(1.0); }
void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
