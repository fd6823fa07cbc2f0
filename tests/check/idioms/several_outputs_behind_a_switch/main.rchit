#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec4 v;
void main() { v = vec4(0.7, 0.6, 0.5, gl_HitTEXT); }
