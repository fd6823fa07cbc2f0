// SPDX-License-Identifier: Apache-2.0
// Images of the lecture form: a uniform sampler2D is an index into the textures, and sampler2D in the program means
// gsnImage. Lookups are those of GLSL at the finest mip level, with t upwards: (0, 0) is the lower left corner.
struct gsnImage {
  uint index;
};

vec4 texture(gsnImage image, vec2 st) {
  if (image.index == kNoTexture) return vec4(1.0);
  return textureLod(textures[nonuniformEXT(image.index)], vec2(st.x, 1.0 - st.y), 0.0);
}
vec4 texture(gsnImage image, vec2 st, float bias) { return texture(image, st); }
vec4 textureLod(gsnImage image, vec2 st, float lod) { return texture(image, st); }
vec4 textureGrad(gsnImage image, vec2 st, vec2 dx, vec2 dy) { return texture(image, st); }
ivec2 textureSize(gsnImage image, int lod) {
  if (image.index == kNoTexture) return ivec2(1);
  return textureSize(textures[nonuniformEXT(image.index)], 0);
}
vec4 texelFetch(gsnImage image, ivec2 texel, int lod) {
  const ivec2 size = textureSize(image, 0);
  if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size))) return vec4(0.0);
  if (image.index == kNoTexture) return vec4(1.0);
  return texelFetch(textures[nonuniformEXT(image.index)], ivec2(texel.x, size.y - 1 - texel.y), 0);
}
