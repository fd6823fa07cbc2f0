#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT float light;
void main() { light = gl_HitKindEXT == gl_HitKindFrontFacingTriangleEXT ? 1.0 : 0.25; }
