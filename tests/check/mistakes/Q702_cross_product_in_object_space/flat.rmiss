#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 cor;
void main() { cor = vec3(0.8, 0.9, 1.0); }
