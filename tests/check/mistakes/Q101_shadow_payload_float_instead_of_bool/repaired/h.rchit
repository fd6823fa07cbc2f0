#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec4 r;
layout(location = 1) rayPayloadEXT bool isShadowed;
void main()
{
  vec3  origin = gl_WorldRayOriginEXT + gl_WorldRayDirectionEXT * gl_HitTEXT;
  uint  flags  = gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsOpaqueEXT | gl_RayFlagsSkipClosestHitShaderEXT;
  isShadowed   = true;
  traceRayEXT(topLevelAS, flags, 0xFF, kRay_shadow, kRayTypeCount, kMiss_shadow, origin, 0.001, vec3(0, 1, 0), 1e5, 1);
  r = vec4(vec3(isShadowed ? 0.1 : 1.0), gl_HitTEXT);
}
