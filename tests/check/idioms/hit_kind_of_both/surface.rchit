#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  payload.color = gl_HitKindEXT == gl_HitKindFrontFacingTriangleEXT ? vec3(1.0) : vec3(0.5);
  payload.t = gl_HitTEXT;
}
