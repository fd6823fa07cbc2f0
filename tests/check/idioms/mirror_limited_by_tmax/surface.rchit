#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"

layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 1) rayPayloadEXT Payload inner;

void main() {
  const float t = gl_HitTEXT;
  const vec3 position = gl_WorldRayOriginEXT + t * gl_WorldRayDirectionEXT;
  const vec3 reflected = reflect(gl_WorldRayDirectionEXT, vec3(0.0, 1.0, 0.0));
  payload.color = vec3(0.0);
  payload.t = t;
  if (payload.depth > 2u) return;
  inner.depth = payload.depth + 1u;
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, kRay_primary, kRayTypeCount, kMiss_primary, position, 0.001,
              reflected, 10.0 / float(1u + payload.depth), 1);
  payload.color = 0.8 * inner.color;
}
