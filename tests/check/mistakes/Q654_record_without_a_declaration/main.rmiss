#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 payload;
layout(shaderRecordEXT, std430) buffer SBT { float r; float g; float b; };  // EXPECT Q654
void main() { payload = vec3(r, g, b); }
