#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"

layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 1) rayPayloadEXT Shadow shadow;

const vec3 kToLight = vec3(0.0, 1.0, 0.0);

void main() {
  const vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  const vec3 column = gl_ObjectToWorldEXT[gl_PrimitiveID & 3];
  shadow.visible = 0u;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_shadow,
              kRayTypeCount, kMiss_shadow, position, 0.001, kToLight, kInfinity, 1);
  payload.color = shadow.visible != 0u ? column : vec3(0.1);
  payload.t = gl_HitTEXT;
}
