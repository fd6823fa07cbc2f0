#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Colors {  // EXPECT Q651
  vec4 colors[];
};
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 baryCoord;

void main() {
  payload.color = colors[gl_InstanceCustomIndexEXT].rgb;
  payload.t = gl_HitTEXT;
}
