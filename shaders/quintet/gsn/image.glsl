// Images of a program of the lecture form: a uniform sampler2D is an index of the scene's textures, or none, which
// is white. The program's word sampler2D means gsnImage; look-ups are those of GLSL, of the finest level.
struct gsnImage {
  uint index;
};

vec4 texture(gsnImage image, vec2 uv) {
  if (image.index == kNoTexture) return vec4(1.0);
  return textureLod(textures[nonuniformEXT(image.index)], uv, 0.0);
}
vec4 texture(gsnImage image, vec2 uv, float bias) { return texture(image, uv); }
vec4 textureLod(gsnImage image, vec2 uv, float lod) { return texture(image, uv); }
vec4 textureGrad(gsnImage image, vec2 uv, vec2 dx, vec2 dy) { return texture(image, uv); }
ivec2 textureSize(gsnImage image, int lod) {
  if (image.index == kNoTexture) return ivec2(1);
  return textureSize(textures[nonuniformEXT(image.index)], 0);
}
vec4 texelFetch(gsnImage image, ivec2 texel, int lod) {
  if (image.index == kNoTexture) return vec4(1.0);
  return texelFetch(textures[nonuniformEXT(image.index)], texel, 0);
}
