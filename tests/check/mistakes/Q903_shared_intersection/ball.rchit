#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT BallHit hit;

void main() {
  payload.color = 0.5 + 0.5 * hit.normal;
  payload.t = gl_HitTEXT;
}
