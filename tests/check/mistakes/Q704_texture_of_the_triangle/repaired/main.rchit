#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_nonuniform_qualifier : require
#include <quintet/generated/program.glsl>
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec2 b;
vec4 sampleMap(uint id, vec2 uv) {
  return textureLod(textures[nonuniformEXT(id)], uv, 0.0);
}
void main() {
  const uint id = (gl_PrimitiveID & 1) == 0 ? parameters.bark : parameters.moss;
  c = sampleMap(id, b).rgb;
}
