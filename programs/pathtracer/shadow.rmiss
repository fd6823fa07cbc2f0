// Nothing is in the way.
#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/payload.glsl>

layout(location = 1) rayPayloadInEXT ShadowPayload payload;

void main() { payload.visible = 1u; }
