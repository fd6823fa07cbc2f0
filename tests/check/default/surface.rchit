#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 baryCoord;

void main() {
  payload.color = vec3(baryCoord, 1.0);
  payload.t = gl_HitTEXT;
}
