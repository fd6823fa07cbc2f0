#version 460
#extension GL_EXT_ray_tracing : require
#include "p.glsl"
layout(location = 0) rayPayloadInEXT Payload p;
void main() { p.light = 0.0; }
