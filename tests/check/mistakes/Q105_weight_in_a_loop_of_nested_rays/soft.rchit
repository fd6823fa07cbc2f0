#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#include "p.glsl"
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Payload p;

void main() {
  const vec3 x = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  float sum = 0.0;
  p.light = 0.5 * abs(gl_WorldRayDirectionEXT.y);
  for (int i = 0; i < 2; ++i) {
    const vec3 l = normalize(vec3(float(i) - 0.5, 6.0, 1.0));
    // EXPECT+1 Q105
    traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT, 0xFF, kRay_shadow,
                kRayTypeCount, kMiss_shadow, x, 0.001, l, 100.0, 0);
    sum += p.light;
  }
  p.color = vec3(sum);
  p.light = 1.0;
}
