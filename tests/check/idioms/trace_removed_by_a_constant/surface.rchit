#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"

layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
const bool kShadows = false;
layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 1) rayPayloadEXT Shadow shadow;
hitAttributeEXT vec2 baryCoord;

void main() {
  const vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  shadow.visible = baryCoord.x;
  if (kShadows)
    traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_primary, kRayTypeCount,
                kMiss_primary, position, 0.001, vec3(0.0, 1.0, 0.0), kInfinity, 1);
  payload.color = vec3(baryCoord, 1.0) * shadow.visible;
}
