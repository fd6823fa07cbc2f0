#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec4 r;
void main() { r = vec4(0.3, 0.4, 0.5, -1.0); }
