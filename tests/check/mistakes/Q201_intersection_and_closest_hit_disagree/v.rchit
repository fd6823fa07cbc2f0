#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec3 n;  // EXPECT Q201
void main() { c = 0.5 + 0.5 * normalize(n); }
