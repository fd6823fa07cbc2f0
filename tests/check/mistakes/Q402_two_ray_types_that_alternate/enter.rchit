#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"

layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  const vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  payload.color = vec3(0.1);
  payload.t = gl_HitTEXT;
  payload.depth++;
  if (payload.depth < 8)
    traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, kRay_inside, kRayTypeCount, kMiss_inside, position, 0.001,
                gl_WorldRayDirectionEXT, kInfinity, 0);
}
