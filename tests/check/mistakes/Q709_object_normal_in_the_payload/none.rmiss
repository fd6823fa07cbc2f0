#version 460
#extension GL_EXT_ray_tracing : require
#include "gbuffer.glsl"
layout(location = 0) rayPayloadInEXT GBuffer g;
void main() { g = GBuffer(vec3(0.0), vec3(0.0), false); }
