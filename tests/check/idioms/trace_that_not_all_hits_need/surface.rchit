#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"

layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 baryCoord;

void main() {
  const vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  payload.color = vec3(baryCoord, 0.5);
  if (gl_PrimitiveID == 0)
    traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, kRay_mirrored, kRayTypeCount,
                kMiss_mirrored, position, 0.001, -gl_WorldRayDirectionEXT, kInfinity, 0);
  payload.color *= 0.9;
}
