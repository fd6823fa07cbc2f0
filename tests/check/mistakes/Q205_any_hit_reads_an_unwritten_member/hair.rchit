#version 460
#extension GL_EXT_ray_tracing : require
#include "attr.glsl"
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT Strand strand;
void main() { c = vec3(0.3, 0.2, 0.1) * fract(5.0 * strand.along); }
