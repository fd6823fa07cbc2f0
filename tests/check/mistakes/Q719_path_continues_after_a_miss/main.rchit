#version 460
#extension GL_EXT_ray_tracing : require
struct Hit { vec3 normal; float distance; };
layout(location = 0) rayPayloadInEXT Hit hit;
void main() { hit = Hit(-gl_WorldRayDirectionEXT, gl_HitTEXT); }
