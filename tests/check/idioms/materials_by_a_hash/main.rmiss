#version 460
#extension GL_EXT_ray_tracing : require
struct Hit { vec3 normal; float t; uint object; };
layout(location = 0) rayPayloadInEXT Hit hit;
void main() { hit = Hit(vec3(0.0), -1.0, 0u); }
