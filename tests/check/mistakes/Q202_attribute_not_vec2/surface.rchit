#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec3 baryCoord;  // EXPECT Q202

void main() {
  payload.color = baryCoord;
  payload.t = gl_HitTEXT;
}
