#version 460
#extension GL_EXT_ray_tracing : require
#include "payloads.glsl"
layout(location = 0) rayPayloadInEXT Radiance radiance;
void main() { radiance.color = vec3(0.1, 0.4, 0.1); }
