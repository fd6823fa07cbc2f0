#version 460
#extension GL_EXT_ray_tracing : require
#include "common.h"
layout(location = 0) rayPayloadInEXT Payload prd;
hitAttributeEXT vec2 attribs;
void main() {
  prd.color = vec3(attribs, 0.0);
  prd.t = gl_HitTEXT;
}
