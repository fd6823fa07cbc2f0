#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec3 L;
layout(location = 1) rayPayloadEXT vec3 beyond;
void main() {
  // A second try with a mirrored direction.
  const vec3 d = gl_WorldRayDirectionEXT * vec3(-1.0, 1.0, -1.0);
  beyond = vec3(0.0);
  traceRayEXT(topLevelAS, 0u, 0xFFu, kRay_far, kRayTypeCount, kMiss_far, vec3(0.0), 0.0, d, 1e4, 1);  // EXPECT Q403
  L = 0.5 * beyond + vec3(0.1);
}
