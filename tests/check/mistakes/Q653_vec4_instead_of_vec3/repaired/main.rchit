#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_scalar_block_layout : require
#include <quintet/frame.glsl>
#include <quintet/generated/record.glsl>
layout(location = 0) rayPayloadInEXT vec3 c;
void main() { c = record.diffuse * (1.0 - record.gloss); }
