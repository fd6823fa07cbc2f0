#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT float light;
void main() { light = 0.0; }
