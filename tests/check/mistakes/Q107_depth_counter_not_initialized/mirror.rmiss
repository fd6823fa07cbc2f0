#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"
layout(location = 0) rayPayloadInEXT Payload prd;
void main() { prd.color = vec3(0.4, 0.6, 0.9); }
