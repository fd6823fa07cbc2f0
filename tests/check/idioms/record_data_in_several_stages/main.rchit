#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/generated/record.glsl>
layout(location = 0) rayPayloadInEXT vec3 c;
void main() {
  c = record.tint;
  if (record.pattern == kRecord_pattern_rings) c *= fract(4.0 * gl_HitTEXT);
}
