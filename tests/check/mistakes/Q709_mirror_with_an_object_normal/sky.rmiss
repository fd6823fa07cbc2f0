#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 L;
void main() { L = mix(vec3(1.0), vec3(0.2, 0.4, 0.8), 0.5 * gl_WorldRayDirectionEXT.y + 0.5); }
