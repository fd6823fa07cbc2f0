#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT float up;
void main() { up = 0.5 + 0.5 * gl_WorldRayDirectionEXT.y; }
