#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#define USE_SHADOWS 0
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec3 L;
layout(location = 1) rayPayloadEXT vec3 shadowed;

void main() {
  float visibility = 1.0;
#if USE_SHADOWS
  shadowed = vec3(0.0);
  traceRayEXT(topLevelAS, gl_RayFlagsSkipClosestHitShaderEXT, 0xFF, 0, 1, 0,
              gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT, 0.01, vec3(0, 1, 0), 100.0, 1);
  visibility = shadowed.x;
#endif
  L = vec3(0.8) * visibility;
}
