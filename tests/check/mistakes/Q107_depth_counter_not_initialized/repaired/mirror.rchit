#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Payload prd;
void main() {
  prd.color = vec3(0.1);
  if (prd.info.depth < 3) {
    prd.info.depth++;
    const vec3 p = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
    traceRayEXT(topLevelAS, 0u, 0xFFu, kRay_primary, kRayTypeCount, kMiss_primary, p, 0.001,
                reflect(gl_WorldRayDirectionEXT, vec3(0.0, 1.0, 0.0)), kInfinity, 0);
    prd.color *= 0.9;
  }
}
