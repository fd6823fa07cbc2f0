#version 460
#extension GL_EXT_ray_tracing : require
#include "data.glsl"
layout(location = 0) rayPayloadInEXT Step step_;
void main() {
  step_.position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  step_.done = false;
  step_.emission = gl_InstanceCustomIndexEXT == 5 ? vec3(10.0) : vec3(0.0);
}
