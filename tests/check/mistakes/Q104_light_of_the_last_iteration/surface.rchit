#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"

layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  const vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  vec3 sum = vec3(0.0);
  payload.lit = false;
  for (int i = 0; i < 4; ++i) {
    // EXPECT+1 Q104
    traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_shadow, kRayTypeCount,
                kMiss_shadow, position, 0.001, vec3(sin(float(i)), 1.0, cos(float(i))), kInfinity, 0);
    if (payload.lit) sum += 0.25;
  }
  payload.color = sum;
}
