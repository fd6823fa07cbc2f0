#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec4 p;
void main() { p = vec4(0.5, 0.7, 0.9, 0.0); }
