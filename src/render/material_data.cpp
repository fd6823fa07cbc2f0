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
  if (isPane(m)) flags |= shared::kMaterialPane;
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

const scene::Material* find(const scene::Scene& scene, int material) {
  return material == scene::kNone ? nullptr : &scene.materials[static_cast<std::size_t>(material)];
}

bool anyTransparent(const scene::Geometry& geometry) {
  return std::ranges::any_of(geometry.colors, [](const vec4& c) { return c.a < 1.0f; });
}

// Does any material of the set satisfy the condition? A custom set has one material; solids have their own.
template <typename Condition>
bool anyMaterial(const scene::Scene& scene, const scene::PrimitiveSet& set, Condition condition) {
  const auto fits = [&](int material) {
    const scene::Material* m = find(scene, material);
    return m && condition(*m);
  };
  return fits(set.material) || std::ranges::any_of(set.primitives, fits, &scene::Primitive::material);
}

}  // namespace

bool needsAlphaTest(const scene::Scene& scene, const scene::Geometry& geometry) {
  const scene::Material* m = find(scene, geometry.material);
  if (!m || m->alphaMode == scene::AlphaMode::opaque) return false;
  return anyTransparent(geometry) || canBeTransparent(scene, *m);
}

bool needsAlphaTest(const scene::Scene& scene, const scene::PrimitiveSet& set) {
  return anyMaterial(scene, set, [&](const scene::Material& m) { return canBeTransparent(scene, m); });
}

bool isPane(const scene::Material& m) {
  // A lobe below alpha = roughness² = 5e-4 (kDeltaAlpha) is a delta; a texture can make it smooth in places.
  const bool smooth = m.roughness * m.roughness < 5.001e-4f || m.metallicRoughnessTexture.used();
  const bool metal = m.metallic >= 1.0f && !m.metallicRoughnessTexture.used();
  return m.transmission > 0.0f && m.thickness <= 0.0f && smooth && !metal && !m.unlit;
}

bool isPane(const scene::Scene& scene, const scene::Geometry& geometry) {
  const scene::Material* m = find(scene, geometry.material);
  return m && isPane(*m);
}

bool isPane(const scene::Scene& scene, const scene::PrimitiveSet& set) {
  return set.kind != scene::PrimitiveSetKind::custom &&
         anyMaterial(scene, set, [](const scene::Material& m) { return isPane(m); });
}

bool tintsShadows(const scene::Scene& scene, const scene::Geometry& geometry) {
  const scene::Material* m = find(scene, geometry.material);
  return m && (isPane(*m) || (m->alphaMode == scene::AlphaMode::blend && needsAlphaTest(scene, geometry)));
}

bool tintsShadows(const scene::Scene& scene, const scene::PrimitiveSet& set) {
  if (set.kind == scene::PrimitiveSetKind::custom) return false;
  return anyMaterial(scene, set, [&](const scene::Material& m) {
    return isPane(m) || (m.alphaMode == scene::AlphaMode::blend && canBeTransparent(scene, m));
  });
}

}  // namespace quintet::render
