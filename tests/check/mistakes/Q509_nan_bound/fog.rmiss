#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec4 result;
void main() { result = vec4(0.6, 0.65, 0.7, 0.0); }
