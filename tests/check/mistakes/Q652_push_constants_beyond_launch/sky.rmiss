#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(push_constant) uniform Counters {  // EXPECT Q652
  layout(offset = 40) uint frame;
} counters;
layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  payload.color = vec3(float(counters.frame & 1u));
  payload.t = -1.0;
}
