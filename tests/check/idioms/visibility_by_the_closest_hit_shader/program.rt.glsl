// A shadow ray that runs the closest-hit shader: any hit will do, so it ends at the first one.
struct RayPayloadType { bool occluded; };
const vec3 lamp = vec3(0.0, 4.0, 0.0);

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 p = vec3(3.0 * ndc.x, -2.0, 3.0 * ndc.y);
  float d = distance(p, lamp);
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsOpaqueEXT, 0xFFu, 0u, 0u, 0u, p, 0.001, (lamp - p) / d,
              d, 0);
  gsnSetPixel(vec4(vec3(payload.occluded ? 0.0 : 4.0 / (d * d)), 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.occluded = true; }
void main() { /**** MISS SHADER ****/ payload.occluded = false; }
