#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit.glsl>
#include "hit.glsl"
layout(location = 0) rayPayloadInEXT Hit hit;
hitAttributeEXT vec2 b;
void main() {
  hit.found = true;
  hit.position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  hit.normal = normalize(-gl_WorldRayDirectionEXT);
}
