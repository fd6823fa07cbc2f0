#version 460
#extension GL_EXT_ray_tracing : require
struct HitData { vec3 rgb; float t; };
layout(location = 0) rayPayloadInEXT HitData d;
void main() { d = HitData(vec3(0.8), gl_HitTEXT); }
