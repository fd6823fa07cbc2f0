#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(set = 0, binding = 1) uniform sampler2D albedo;  // EXPECT Q651
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 baryCoord;

void main() {
  payload.color = textureLod(albedo, baryCoord, 0.0).rgb;
  payload.t = gl_HitTEXT;
}
