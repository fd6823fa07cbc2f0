// SPDX-License-Identifier: Apache-2.0
// Texture coordinates and lookups. Ray tracing stages have no derivatives and the textures have no mip levels: textures
// are filtered by many samples per pixel.
#ifndef QUINTET_TEXTURE_GLSL
#define QUINTET_TEXTURE_GLSL

#include "frame.glsl"

vec4 sampleTexture(TextureData use, vec2 uv) {
  const vec2 st = vec2(dot(use.rowU, vec3(uv, 1.0)), dot(use.rowV, vec3(uv, 1.0)));
  return textureLod(textures[nonuniformEXT(use.index)], st, 0.0);
}

// Texture coordinates of set 0 or 1 at barycentrics b (all three weights); 0 if the geometry has none.
vec2 interpolateUv(GeometryData geometry, uvec3 v, vec3 b, uint uvSet) {
  const Address address = geometry.uvs[uvSet];
  if (address == 0ul) return vec2(0.0);
  Vec2Array uvs = Vec2Array(address);
  return b.x * uvs.at[v.x] + b.y * uvs.at[v.y] + b.z * uvs.at[v.z];
}

// A program parameter of type image is the index of its texture: sampleParameter(parameters.NAME, uv). The lookup is
// bilinear and repeats; (0, 0) is the upper left corner.
vec4 sampleParameter(uint image, vec2 uv) { return textureLod(textures[nonuniformEXT(image)], uv, 0.0); }
vec4 texelParameter(uint image, ivec2 texel) { return texelFetch(textures[nonuniformEXT(image)], texel, 0); }
ivec2 parameterSize(uint image) { return textureSize(textures[nonuniformEXT(image)], 0); }

#endif
