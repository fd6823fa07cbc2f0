#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(push_constant) uniform Settings {  // EXPECT Q652
  vec4 tint;
} settings;
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 baryCoord;

void main() {
  payload.color = settings.tint.rgb;
  payload.t = gl_HitTEXT;
}
