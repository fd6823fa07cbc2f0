#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"

layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  const vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  payload.light = parameters.ambient;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_shadow, kRayTypeCount,
              kMiss_shadow, position, 0.001, vec3(0.0, 1.0, 0.0), kInfinity, 0);
  payload.color = vec3(0.7) * payload.light;
}
