// SPDX-License-Identifier: Apache-2.0
#extension GL_EXT_nonuniform_qualifier : require
struct Radiance {
  vec3 color;
  float distance;
};
layout(set = 1, binding = 0) uniform sampler2D textures[];
layout(set = 1, binding = 1, std430) readonly buffer Materials { vec4 color; } materials[];
layout(shaderRecordEXT, std430) buffer Record {
  int texture;  // -1 without one
  uint firstMaterial;
} record;
layout(location = 0) rayPayloadInEXT Radiance radiance;
hitAttributeEXT vec2 weights;

void main() {
  vec3 color = materials[nonuniformEXT(record.firstMaterial + gl_GeometryIndexEXT)].color.rgb;
  if (record.texture >= 0) color *= textureLod(textures[nonuniformEXT(record.texture)], weights, 0.0).rgb;
  radiance = Radiance(color, gl_HitTEXT);
}
