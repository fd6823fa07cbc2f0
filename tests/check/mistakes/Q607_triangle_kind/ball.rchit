#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  // EXPECT+1 Q607
  const bool front = gl_HitKindEXT == gl_HitKindFrontFacingTriangleEXT;
  payload.color = front ? vec3(0.9) : vec3(0.2);
  payload.t = gl_HitTEXT;
}
