#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec3 L;
layout(location = 1) rayPayloadEXT bool shadowed;
void main() {
  const vec3 origin = gl_WorldRayOriginEXT + gl_WorldRayDirectionEXT * gl_HitTEXT;
  shadowed = true;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsOpaqueEXT | gl_RayFlagsSkipClosestHitShaderEXT,
              0xFF, 0, 0, kMiss_lit, origin, 0.001, normalize(vec3(2, 5, 3)), 1000.0, 1);
  L = shadowed ? vec3(0.1) : vec3(0.8);
}
