#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec3 L;
layout(location = 1) rayPayloadEXT float lit;
void main() {
  const vec3 x = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  lit = 0.0;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFF, kRay_shadow,
              kRayTypeCount, kMiss_shadow, x, 0.001, vec3(0, 1, 0), kInfinity, 1);
  L = vec3(0.2 + 0.6 * lit);
}
