#include "render/material_data.h"

#include <algorithm>
#include <cmath>

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

// Beer-Lambert coefficient that turns white into `color` after `distance`.
vec3 absorption(const vec3& color, float distance) {
  if (!std::isfinite(distance) || distance <= 0.0f) return vec3(0.0f);
  return -glm::log(glm::clamp(color, vec3(1e-6f), vec3(1.0f))) / distance;
}

std::uint32_t materialFlags(const scene::Material& m) {
  std::uint32_t flags = 0;
  if (m.alphaMode == scene::AlphaMode::mask) flags |= shared::kMaterialMask;
  if (m.alphaMode == scene::AlphaMode::blend) flags |= shared::kMaterialBlend;
  if (m.unlit) flags |= shared::kMaterialUnlit;
  if (m.thickness <= 0.0f) flags |= shared::kMaterialThin;
  if (glm::any(glm::greaterThan(m.emissive, vec3(0.0f)))) flags |= shared::kMaterialEmissive;
  if (m.doubleSided) flags |= shared::kMaterialDoubleSided;
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
  data.baseColorTexture = makeTexture(m.baseColorTexture, true, textureIndex);
  data.metallicRoughnessTexture = makeTexture(m.metallicRoughnessTexture, false, textureIndex);
  data.normalTexture = makeTexture(m.normalTexture, false, textureIndex);
  data.emissiveTexture = makeTexture(m.emissiveTexture, true, textureIndex);
  data.transmissionTexture = makeTexture(m.transmissionTexture, false, textureIndex);
  data.specularTexture = makeTexture(m.specularTexture, false, textureIndex);
  data.specularColorTexture = makeTexture(m.specularColorTexture, true, textureIndex);
  data.clearcoatTexture = makeTexture(m.clearcoatTexture, false, textureIndex);
  data.clearcoatRoughnessTexture = makeTexture(m.clearcoatRoughnessTexture, false, textureIndex);
  data.clearcoatNormalTexture = makeTexture(m.clearcoatNormalTexture, false, textureIndex);
  const shared::TextureData* textures = &data.baseColorTexture;
  for (std::uint32_t k = 0; k < shared::kTextureCount; ++k)
    if (textures[k].index != shared::kNoTexture) data.flags |= 1u << (shared::kMaterialTextureShift + k);
  return data;
}

namespace {

bool canBeTransparent(const scene::Scene& scene, const scene::Material& m) {
  if (m.alphaMode == scene::AlphaMode::opaque) return false;
  if (m.baseColor.a < 1.0f) return true;
  if (!m.baseColorTexture.used()) return false;
  const int image = scene.textures[static_cast<std::size_t>(m.baseColorTexture.texture)].image;
  return image != scene::kNone && scene.images[static_cast<std::size_t>(image)].image.hasAlpha();
}

}  // namespace

bool needsAlphaTest(const scene::Scene& scene, const scene::Geometry& geometry) {
  if (geometry.material == scene::kNone) return false;
  const scene::Material& m = scene.materials[static_cast<std::size_t>(geometry.material)];
  if (m.alphaMode == scene::AlphaMode::opaque) return false;
  if (std::any_of(geometry.colors.begin(), geometry.colors.end(), [](const vec4& c) { return c.a < 1.0f; })) return true;
  return canBeTransparent(scene, m);
}

bool needsAlphaTest(const scene::Scene& scene, const scene::PrimitiveSet& set) {
  const auto transparent = [&](int material) {
    return material != scene::kNone && canBeTransparent(scene, scene.materials[static_cast<std::size_t>(material)]);
  };
  return transparent(set.material) || std::ranges::any_of(set.primitives, transparent, &scene::Primitive::material);
}

}  // namespace quintet::render
