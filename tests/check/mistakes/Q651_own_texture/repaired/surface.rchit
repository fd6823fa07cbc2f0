#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/texture.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 baryCoord;

void main() {
  payload.color = sampleParameter(parameters.albedo, baryCoord).rgb;
  payload.t = gl_HitTEXT;
}
