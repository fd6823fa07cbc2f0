#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec4 L;
void main() { L = vec4(0.3, 0.5, 0.9, 0.0); }
