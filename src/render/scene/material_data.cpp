// SPDX-License-Identifier: Apache-2.0
#include "render/scene/material_data.h"

#include <algorithm>
#include <cmath>

#include "scene/model/material_textures.h"
#include "scene/model/surface_class.h"

namespace quintet::render {
namespace {

shared::TextureData makeTexture(const scene::TextureUse& use, bool sRgb, const TextureIndex& textureIndex) {
  shared::TextureData data{};
  data.index = use.used() ? textureIndex(use.texture, sRgb) : shared::kNoTexture;
  data.uvSet = static_cast<std::uint32_t>(use.uvSet);
  // KHR_texture_transform: translation · rotation · scale, with rotation [c s; -s c].
  const float c = std::cos(use.rotation);
  const float s = std::sin(use.rotation);
  data.rowU = {c * use.scale.x, s * use.scale.y, use.offset.x};
  data.rowV = {-s * use.scale.x, c * use.scale.y, use.offset.y};
  return data;
}

constexpr float kMostAnisotropic = 0.999f;  // the phase function of 1 is a delta distribution

// Beer-Lambert coefficient that turns white into `color` after `distance`.
vec3 absorption(const vec3& color, float distance) {
  if (!std::isfinite(distance) || distance <= 0.0f) return vec3(0.0f);
  return -glm::log(glm::clamp(color, vec3(1e-6f), vec3(1.0f))) / distance;
}

// The albedo of a single scattering that gives the color `multiple` after many (C. Kulla and A. Conty, "Revisiting
// Physically Based Shading at Imageworks", 2017; the formula of KHR_materials_volume_scatter).
vec3 singleScatteringAlbedo(const vec3& multiple) {
  vec3 single;
  for (glm::length_t i = 0; i < 3; ++i) {
    const double m = std::clamp(static_cast<double>(multiple[i]), 0.0, 1.0);
    const double root = 4.09712 + 4.20863 * m - std::sqrt(9.59217 + 41.6808 * m + 17.7126 * m * m);
    // The formula is not exactly 0 for black.
    single[i] = m > 0.0 ? static_cast<float>(std::clamp(1.0 - root * root, 0.0, 1.0)) : 0.0f;
  }
  return single;
}

std::uint32_t materialFlags(const scene::Material& m) {
  std::uint32_t flags = 0;
  if (m.alphaMode == scene::AlphaMode::mask) flags |= shared::kMaterialMask;
  if (m.alphaMode == scene::AlphaMode::blend) flags |= shared::kMaterialBlend;
  if (m.unlit) flags |= shared::kMaterialUnlit;
  if (m.thickness <= 0.0f) flags |= shared::kMaterialThin;
  if (glm::any(glm::greaterThan(m.emissive, vec3(0.0f)))) flags |= shared::kMaterialEmissive;
  if (m.doubleSided) flags |= shared::kMaterialDoubleSided;
  if (scene::isPane(m)) flags |= shared::kMaterialPane;
  if (scene::isMedium(m)) flags |= shared::kMaterialSolid;
  return flags;
}

}  // namespace

shared::MaterialData makeMaterial(const scene::Material& m, const TextureIndex& textureIndex) {
  shared::MaterialData data{};
  data.baseColor = m.baseColor;
  data.emissive = m.emissive;
  data.metallic = m.metallic;
  data.roughness = m.roughness;
  data.normalScale = m.normalScale;
  data.alphaCutoff = m.alphaCutoff;
  data.ior = m.ior;
  data.transmission = m.transmission;
  data.specular = m.specular;
  data.specularColor = m.specularColor;
  data.clearcoat = m.clearcoat;
  data.clearcoatRoughness = m.clearcoatRoughness;
  data.clearcoatNormalScale = m.clearcoatNormalScale;
  data.absorption = m.thickness > 0.0f ? absorption(m.attenuationColor, m.attenuationDistance) : vec3(0.0f);
  data.flags = materialFlags(m);
  data.sheenColor = m.sheenColor;
  data.sheenRoughness = m.sheenRoughness;
  data.diffuseTransmissionColor = m.diffuseTransmissionColor;
  data.diffuseTransmission = m.diffuseTransmission;
  data.anisotropy = m.anisotropy;
  data.anisotropyDirection = {std::cos(m.anisotropyRotation), std::sin(m.anisotropyRotation)};
  data.iridescence = m.iridescence;
  data.iridescenceIor = m.iridescenceIor;
  data.iridescenceThicknessMinimum = m.iridescenceThicknessMinimum;
  data.iridescenceThicknessMaximum = m.iridescenceThicknessMaximum;
  data.dispersion = m.thickness > 0.0f ? m.dispersion : 0.0f;
  if (scene::scatters(m)) data.scatteringAlbedo = singleScatteringAlbedo(m.multiscatterColor);
  data.scatterAnisotropy = std::clamp(m.scatterAnisotropy, -kMostAnisotropic, kMostAnisotropic);
  data.dielectricPriority = m.dielectricPriority;
  static_assert(scene::kMaterialTextures.size() == shared::kTextureCount + 1);
  shared::TextureData* textures = &data.baseColorTexture;
  for (std::uint32_t k = 0; k < shared::kTextureCount; ++k) {
    const scene::MaterialTexture& texture = scene::kMaterialTextures[k];
    textures[k] = makeTexture(m.*texture.use, texture.sRgb, textureIndex);
    if (textures[k].index != shared::kNoTexture) data.flags |= 1u << (shared::kMaterialTextureShift + k);
  }
  return data;
}

}  // namespace quintet::render
