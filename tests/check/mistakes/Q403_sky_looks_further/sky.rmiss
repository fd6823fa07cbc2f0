#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"

layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 1) rayPayloadEXT Payload inner;

void main() {
  // EXPECT+1 Q403
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, kRay_primary, kRayTypeCount, kMiss_primary, gl_WorldRayOriginEXT,
              0.001, -gl_WorldRayDirectionEXT, kInfinity, 1);
  payload.color = 0.5 * inner.color;
  payload.t = -1.0;
}
