#version 460
#extension GL_EXT_ray_tracing : require
#include "common.h"
layout(location = 0) rayPayloadInEXT Payload prd;
void main() {
  prd.color = vec3(0.5);
  prd.t = -1.0;
}
