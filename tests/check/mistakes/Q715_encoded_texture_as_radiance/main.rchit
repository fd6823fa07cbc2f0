#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/texture.glsl>
#include <quintet/generated/program.glsl>
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec2 b;
void main() { c = sampleParameter(parameters.wood, b).rgb * 0.8; }
