#version 460
#extension GL_EXT_ray_tracing : require
#include "data.glsl"
layout(location = 0) rayPayloadInEXT Sight sight;
void main() {
  sight.point = gl_WorldRayOriginEXT + gl_WorldRayDirectionEXT * gl_HitTEXT;
  sight.blocked = true;
}
