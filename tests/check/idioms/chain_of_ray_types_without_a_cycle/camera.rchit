#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec3 L;
void main() {
  const vec3 x = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  traceRayEXT(topLevelAS, 0, 0xFF, kRay_mirror, kRayTypeCount, kMiss_mirror, x, 0.001,
              reflect(gl_WorldRayDirectionEXT, vec3(0, 1, 0)), kInfinity, 0);
  L = 0.1 + 0.8 * L;
}
