// The ray left the scene: t stays negative.
#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/payload.glsl>

layout(location = 0) rayPayloadInEXT HitPayload payload;

void main() { payload.t = -1.0; }
