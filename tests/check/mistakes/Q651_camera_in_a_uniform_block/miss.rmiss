#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 colour;
void main() { colour = abs(gl_WorldRayDirectionEXT); }
