#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/record.glsl>
layout(location = 0) rayPayloadInEXT vec3 payload;
void main() { payload = vec3(record.r); }
