#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec4 p;
layout(location = 1) rayPayloadEXT vec4 q;
void main() {
  const vec3 x = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  q = vec4(1.0);
  const vec3 sun = normalize(vec3(0.2, 1.0, 0.4));
  const uint flags = gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsOpaqueEXT;
  // EXPECT+1 Q401
  traceRayEXT(topLevelAS, flags, 0xff, kRay_radiance, kRayTypeCount, kMiss_radiance, x, 1e-3, sun, 1e4, 1);
  p = vec4(q.w > 0.5 ? vec3(0.1) : vec3(0.8), 1.0);
}
