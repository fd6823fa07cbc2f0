#version 460
#extension GL_EXT_ray_tracing : require
#include "data.glsl"
layout(location = 0) rayPayloadInEXT Step step_;
void main() { step_ = Step(vec3(0.8), vec3(0.0), true); }
