#version 460
#extension GL_EXT_ray_tracing : require
#include "hit.glsl"
layout(location = 0) rayPayloadInEXT Hit hit;
void main() { hit.found = false; }
