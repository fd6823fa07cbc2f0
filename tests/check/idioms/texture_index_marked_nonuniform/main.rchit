#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_nonuniform_qualifier : require
#include <quintet/texture.glsl>
#include <quintet/generated/program.glsl>
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec2 b;
void main() {
  const uint index = parameters.pattern;
  c = texture(textures[nonuniformEXT(index)], b).rgb * sampleParameter(parameters.pattern, b.yx).rgb;
}
