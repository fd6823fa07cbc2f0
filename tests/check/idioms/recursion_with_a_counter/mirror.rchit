#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Bounce bounce;
void main() {
  if (bounce.remaining == 0u) {
    bounce.color = vec3(0.0);
    return;
  }
  bounce.remaining--;
  const vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  const vec3 normal = -sign(gl_WorldRayDirectionEXT.y) * vec3(0.0, 1.0, 0.0);
  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT, 0xFF, kRay_eye, kRayTypeCount, kMiss_eye, position, 1e-3,
              reflect(gl_WorldRayDirectionEXT, normal), kInfinity, 0);
  bounce.color *= vec3(0.9, 0.8, 0.7);
}
