// The mean emission of triangles, textures included: the radiance factor of an emissive triangle's power.
#ifndef QUINTET_RENDER_EMISSION_MAP_H
#define QUINTET_RENDER_EMISSION_MAP_H

#include "scene/scene.h"

namespace quintet::render {

// Luminance of a material's emission with its texture, as a pyramid of box-filtered levels.
class EmissionMap {
 public:
  EmissionMap(const scene::Scene& scene, const scene::Material& material);

  // 0 everywhere: such a material makes no light.
  bool black() const { return factor_ <= 0.0f && mean_ <= 0.0f; }
  int uvSet() const { return use_.uvSet; }

  // Mean over the triangle with these texture coordinates (before the texture's transform). All texels that
  // bilinear interpolation could show on it count, so it is 0 only if the whole triangle is black.
  float meanOver(vec2 a, vec2 b, vec2 c) const;

 private:
  struct Level {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<float> luminance;
  };
  vec2 texelPosition(vec2 uv) const;
  float blockAt(const Level& level, int shift, long x, long y) const;

  scene::TextureUse use_;
  scene::Sampler sampler_;
  float factor_ = 0.0f;        // without texture: the luminance itself
  float mean_ = 0.0f;          // of the whole texture
  std::vector<Level> levels_;  // level i + 1 has half the size, rounded up; empty: no texture
};

}  // namespace quintet::render
#endif
