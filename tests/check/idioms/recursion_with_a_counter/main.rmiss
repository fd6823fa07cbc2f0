#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"
layout(location = 0) rayPayloadInEXT Bounce bounce;
void main() { bounce.color = 0.5 + 0.5 * gl_WorldRayDirectionEXT; }
