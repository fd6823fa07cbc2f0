#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec3 c;
layout(location = 1) rayPayloadEXT bool open;
void main() {
  vec3 at = gl_WorldRayOriginEXT + gl_WorldRayDirectionEXT * gl_HitTEXT;
  open = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFF, kRay_shadow,
              kRayTypeCount, kMiss_shadow, at, parameters.bias, normalize(vec3(1.0, 4.0, 2.0)), 1e4, 1);
  c = open ? vec3(0.8) : vec3(0.05);
}
