#version 460
#extension GL_EXT_ray_tracing : require
#include "p.glsl"
layout(location = 0) rayPayloadInEXT Probe probe;
void main() { probe = Probe(gl_HitTEXT, true); }
