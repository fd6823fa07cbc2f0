#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"
layout(location = 0) rayPayloadInEXT Payload prd;
void main() {
  prd.radiance = vec3(0.7, 0.8, 1.0);
  prd.t = -1.0;
  prd.visible = true;
}
