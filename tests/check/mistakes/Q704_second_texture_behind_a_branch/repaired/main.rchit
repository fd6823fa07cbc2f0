#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_nonuniform_qualifier : require
#include <quintet/generated/program.glsl>
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec2 b;
void main() {
  uint id = parameters.bark;
  if (gl_HitKindEXT == gl_HitKindBackFacingTriangleEXT) id = parameters.moss;
  c = textureLod(textures[nonuniformEXT(id)], b, 0.0).rgb;
}
