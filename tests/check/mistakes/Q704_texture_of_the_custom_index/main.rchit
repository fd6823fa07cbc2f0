#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_nonuniform_qualifier : require
#include <quintet/hit_geometry.glsl>
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec2 b;
vec4 sampleMap(uint id, vec2 uv) {
  return textureLod(textures[id], uv, 0.0);  // EXPECT Q704
}
void main() {
  const uint id = hitGeometry().material;
  c = sampleMap(id, b).rgb;
}
