#version 460
#extension GL_EXT_ray_tracing : require
#include "data.glsl"
layout(location = 0) rayPayloadInEXT Step step_;
void main() {
  step_.position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  step_.done = false;
  if (gl_InstanceCustomIndexEXT == 5) step_.emission = vec3(10.0);
}
