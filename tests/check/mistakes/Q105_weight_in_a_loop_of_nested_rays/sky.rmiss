#version 460
#extension GL_EXT_ray_tracing : require
#include "p.glsl"
layout(location = 0) rayPayloadInEXT Payload p;
void main() { p = Payload(vec3(0.4, 0.5, 0.6), 1.0); }
