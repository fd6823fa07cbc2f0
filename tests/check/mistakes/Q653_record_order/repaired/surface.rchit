#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/generated/record.glsl>
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 baryCoord;

void main() {
  payload.color = record.tint * record.roughness;
  payload.t = gl_HitTEXT;
}
