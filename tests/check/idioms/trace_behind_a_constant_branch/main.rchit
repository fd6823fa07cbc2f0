#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec4 L;
layout(location = 1) rayPayloadEXT vec4 mirrored;
const bool kReflections = false;

void main() {
  vec3 color = vec3(0.6);
  if (kReflections) {
    mirrored = vec4(0.0);
    traceRayEXT(topLevelAS, 0, 0xFF, kRay_radiance, kRayTypeCount, kMiss_radiance,
                gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT, 0.01,
                reflect(gl_WorldRayDirectionEXT, vec3(0, 1, 0)), 100.0, 1);
    color += 0.3 * mirrored.rgb;
  }
  L = vec4(color, 1.0);
}
