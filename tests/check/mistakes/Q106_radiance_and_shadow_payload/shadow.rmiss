#version 460
#extension GL_EXT_ray_tracing : require
#include "payloads.glsl"
layout(location = 1) rayPayloadInEXT Shadow shadow;
void main() { shadow.visibility = 1.0; }
