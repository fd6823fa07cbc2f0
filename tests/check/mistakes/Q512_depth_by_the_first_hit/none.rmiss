#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT float tiefe;
void main() { tiefe = 1.0 / 0.001; }
