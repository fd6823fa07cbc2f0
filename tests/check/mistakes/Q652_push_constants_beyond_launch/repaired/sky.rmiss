#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(push_constant) uniform Counters {
  layout(offset = 24) uint firstSample;
} counters;
layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  payload.color = vec3(float(counters.firstSample & 1u));
  payload.t = -1.0;
}
