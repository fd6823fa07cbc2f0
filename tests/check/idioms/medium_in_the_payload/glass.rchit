#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  payload.color = vec3(0.0);
  payload.origin = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  payload.t = gl_HitTEXT;
  payload.absorption = gl_HitKindEXT == gl_HitKindFrontFacingTriangleEXT ? 0.5 : 0.0;
}
