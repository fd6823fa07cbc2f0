#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"

layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  const vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  // EXPECT+1 Q107
  const int depth = payload.depth + 1;
  vec3 color = vec3(0.2);
  if (depth < 4) {
    payload.depth = depth;
    traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, kRay_primary, kRayTypeCount,
                kMiss_primary, position, 0.001, reflect(gl_WorldRayDirectionEXT, vec3(0.0, 1.0, 0.0)), kInfinity, 0);
    color += 0.5 * payload.color;
  }
  payload.color = color;
}
