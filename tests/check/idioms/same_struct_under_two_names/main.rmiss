#version 460
#extension GL_EXT_ray_tracing : require
struct MissData { vec3 sky; float distance; };
layout(location = 0) rayPayloadInEXT MissData d;
void main() { d = MissData(vec3(0.2, 0.3, 0.5), -1.0); }
