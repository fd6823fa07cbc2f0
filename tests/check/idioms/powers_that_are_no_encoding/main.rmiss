#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 c;
// The designer's color #4080ff, decoded to linear.
void main() { c = pow(vec3(64.0, 128.0, 255.0) / 255.0, vec3(2.2)); }
