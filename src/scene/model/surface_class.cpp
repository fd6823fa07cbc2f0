// SPDX-License-Identifier: Apache-2.0
#include "scene/model/surface_class.h"

#include <algorithm>
#include <cmath>

namespace quintet::scene {
namespace {

// Whether parts of the surface can be missing or transparent, without the alpha of vertex colors.
bool canHaveAlpha(const Scene& scene, const Material& m) {
  if (m.alphaMode == AlphaMode::opaque) return false;
  if (m.baseColor.a < 1.0f || isInvisible(m)) return true;
  if (!m.baseColorTexture.used()) return false;
  const int image = scene.textures[static_cast<std::size_t>(m.baseColorTexture.texture)].image;
  return image != kNone && scene.images[static_cast<std::size_t>(image)].image.hasAlpha();
}

// Whether the material satisfies the condition, at any time of the animation.
template <typename Condition>
bool everFits(const Scene& scene, int material, Condition condition) {
  if (material == kNone) return false;
  const auto m = static_cast<std::size_t>(material);
  if (condition(scene.materials[m])) return true;
  return m < scene.materialStates.size() && std::ranges::any_of(scene.materialStates[m], condition);
}

bool anyColorAlpha(const Geometry& geometry) {
  return std::ranges::any_of(geometry.colors, [](const vec4& c) { return c.a < 1.0f; });
}

// Whether any material of the set satisfies the condition. A custom set has one material; solids have their own.
template <typename Condition>
bool anyMaterial(const Scene& scene, const PrimitiveSet& set, Condition condition) {
  const auto fits = [&](int material) { return everFits(scene, material, condition); };
  return fits(set.material) || std::ranges::any_of(set.primitives, fits, &Primitive::material);
}

}  // namespace

bool needsAlphaTest(const Scene& scene, const Geometry& geometry) {
  return everFits(scene, geometry.material, [&](const Material& m) {
    return canHaveAlpha(scene, m) || (m.alphaMode != AlphaMode::opaque && anyColorAlpha(geometry));
  });
}

bool needsAlphaTest(const Scene& scene, const PrimitiveSet& set) {
  return anyMaterial(scene, set, [&](const Material& m) { return canHaveAlpha(scene, m); });
}

bool isInvisible(const Material& m) {
  if (m.alphaMode == AlphaMode::mask) return m.baseColor.a < m.alphaCutoff;
  return m.alphaMode == AlphaMode::blend && m.baseColor.a <= 0.0f;
}

bool isPane(const Material& m) {
  // A texture can make parts of the surface smooth.
  const bool smooth = m.roughness * m.roughness < kPaneAlpha || m.metallicRoughnessTexture.used();
  const bool metal = m.metallic >= 1.0f && !m.metallicRoughnessTexture.used();
  return m.transmission > 0.0f && m.thickness <= 0.0f && smooth && !metal && !m.unlit;
}

bool isMedium(const Material& m) {
  return (m.transmission > 0.0f || m.diffuseTransmission > 0.0f) && m.thickness > 0.0f && !m.unlit;
}

bool scatters(const Material& m) {
  return isMedium(m) && m.multiscatterColor != vec3(0.0f) && m.attenuationColor != vec3(1.0f) &&
         std::isfinite(m.attenuationDistance);
}

bool isPane(const Scene& scene, const Geometry& geometry) {
  return everFits(scene, geometry.material, [](const Material& m) { return isPane(m); });
}

bool isPane(const Scene& scene, const PrimitiveSet& set) {
  return set.kind != PrimitiveSetKind::custom && anyMaterial(scene, set, [](const Material& m) { return isPane(m); });
}

bool tintsShadows(const Scene& scene, const Geometry& geometry) {
  if (isPane(scene, geometry)) return true;
  return everFits(scene, geometry.material, [](const Material& m) { return m.alphaMode == AlphaMode::blend; }) &&
         needsAlphaTest(scene, geometry);
}

bool tintsShadows(const Scene& scene, const PrimitiveSet& set) {
  if (set.kind == PrimitiveSetKind::custom) return false;
  return anyMaterial(scene, set, [&](const Material& m) {
    return isPane(m) || (m.alphaMode == AlphaMode::blend && canHaveAlpha(scene, m));
  });
}

}  // namespace quintet::scene
