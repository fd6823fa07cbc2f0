#version 460
#extension GL_EXT_ray_tracing : require
#include "pack.glsl"
layout(location = 0) rayPayloadInEXT uvec2 packed;
void main() { packed = PACK(vec3(0.5, 0.6, 0.7), -1.0); }
