// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/material.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

#include "base/normal_float.h"
#include "scene/gltf/extensions.h"
#include "scene/model/limits.h"

namespace quintet::scene {
namespace {

constexpr float kHuge = std::numeric_limits<float>::max();

// Reads one material.
class MaterialReader {
 public:
  MaterialReader(const Document& document, TextureTable& textures, Report& report, std::size_t index)
      : from_(document.model.materials[index]),
        textures_(textures),
        report_(report),
        location_(fmt::format("/materials/{}", index)) {}

  Material read() {
    material_.name = from_.name;
    readCore();
    const auto* glossiness = findExtension(from_.extensions, "KHR_materials_pbrSpecularGlossiness");
    if (glossiness)
      readSpecularGlossiness(*glossiness);
    else
      readMetallicRoughness();
    if (const auto* e = findExtension(from_.extensions, "KHR_materials_emissive_strength"))
      multiplyEmission(range(numberOf(*e, "emissiveStrength", 1.0), 0.0f, kHuge, "emissiveStrength"));
    if (const auto* e = findExtension(from_.extensions, "KHR_materials_ior")) {
      if (glossiness)
        ignoreForGlossiness("KHR_materials_ior");
      else
        readIor(*e);
    }
    if (const auto* e = findExtension(from_.extensions, "KHR_materials_transmission")) {
      material_.transmission = unit(numberOf(*e, "transmissionFactor", 0.0), "transmissionFactor");
      material_.transmissionTexture = texture(*e, "transmissionTexture");
    }
    if (const auto* e = findExtension(from_.extensions, "KHR_materials_volume")) readVolume(*e);
    if (const auto* e = findExtension(from_.extensions, "KHR_materials_volume_scatter")) readVolumeScatter(*e);
    if (const auto* e = findExtension(from_.extensions, "KHR_materials_specular")) {
      if (glossiness)
        ignoreForGlossiness("KHR_materials_specular");
      else
        readSpecular(*e);
    }
    if (const auto* e = findExtension(from_.extensions, "KHR_materials_clearcoat")) readClearcoat(*e);
    if (const auto* e = findExtension(from_.extensions, "KHR_materials_sheen")) readSheen(*e);
    if (const auto* e = findExtension(from_.extensions, "KHR_materials_diffuse_transmission"))
      readDiffuseTransmission(*e);
    if (const auto* e = findExtension(from_.extensions, "KHR_materials_anisotropy")) readAnisotropy(*e);
    if (const auto* e = findExtension(from_.extensions, "KHR_materials_iridescence")) readIridescence(*e);
    if (const auto* e = findExtension(from_.extensions, "KHR_materials_dispersion"))
      material_.dispersion = range(numberOf(*e, "dispersion", 0.0), 0.0f, kHuge, "dispersion");
    if (from_.extras.IsObject())
      material_.dielectricPriority = static_cast<float>(numberOf(from_.extras, "dielectric_priority", 0.0));
    material_.unlit = findExtension(from_.extensions, "KHR_materials_unlit") != nullptr;
    return std::move(material_);
  }

 private:
  void readMetallicRoughness() {
    const tinygltf::PbrMetallicRoughness& pbr = from_.pbrMetallicRoughness;
    for (std::size_t i = 0; i < 4; ++i) material_.baseColor[i] = unit(pbr.baseColorFactor[i], "baseColorFactor");
    material_.baseColorTexture = texture(pbr.baseColorTexture, "baseColorTexture");
    material_.metallic = unit(pbr.metallicFactor, "metallicFactor");
    material_.roughness = unit(pbr.roughnessFactor, "roughnessFactor");
    material_.metallicRoughnessTexture = texture(pbr.metallicRoughnessTexture, "metallicRoughnessTexture");
  }

  // A dielectric with the reflectance of the specular color: that of ior 0 is specularColor. What it does not reflect
  // reaches the diffuse base, as in the extension.
  void readSpecularGlossiness(const tinygltf::Value& extension) {
    const vec4 diffuse = vec4Of(extension, "diffuseFactor", vec4(1.0f));
    for (glm::length_t i = 0; i < 4; ++i)
      material_.baseColor[i] = unit(static_cast<double>(diffuse[i]), "diffuseFactor");
    material_.baseColorTexture = texture(extension, "diffuseTexture");
    material_.metallic = 0.0f;
    material_.ior = 0.0f;
    material_.specularColor = range(vec3Of(extension, "specularFactor", vec3(1.0f)), 0.0f, 1.0f, "specularFactor");
    material_.specularColorTexture = texture(extension, "specularGlossinessTexture");
    const float glossiness = unit(numberOf(extension, "glossinessFactor", 1.0), "glossinessFactor");
    material_.roughness = 1.0f - glossiness;
    if (material_.specularColorTexture.used()) {
      material_.roughness = 1.0f;
      // The same texels with another conversion.
      material_.metallicRoughnessTexture = material_.specularColorTexture;
      material_.metallicRoughnessTexture.texture =
          textures_.use(indexOf(extension.Get("specularGlossinessTexture"), "index"),
                        location_ + "/specularGlossinessTexture", glossiness);
    }
  }

  void readCore() {
    material_.normalTexture = texture(from_.normalTexture, "normalTexture");
    material_.normalScale = static_cast<float>(from_.normalTexture.scale);
    material_.occlusionTexture = texture(from_.occlusionTexture, "occlusionTexture");
    material_.occlusionStrength = unit(from_.occlusionTexture.strength, "occlusionTexture/strength");
    // Not all exporters respect the specification's upper limit of 1, and a larger factor is harmless.
    for (std::size_t i = 0; i < 3; ++i)
      material_.emissive[i] = range(from_.emissiveFactor[i], 0.0f, kMaxRadiance, "emissiveFactor");
    material_.emissiveTexture = texture(from_.emissiveTexture, "emissiveTexture");
    if (from_.alphaMode == "MASK") material_.alphaMode = AlphaMode::mask;
    if (from_.alphaMode == "BLEND") material_.alphaMode = AlphaMode::blend;
    material_.alphaCutoff = range(from_.alphaCutoff, 0.0f, kHuge, "alphaCutoff");
    material_.doubleSided = from_.doubleSided;
  }

  void multiplyEmission(float strength) {
    const glm::dvec3 product = glm::dvec3(material_.emissive) * static_cast<double>(strength);
    material_.emissive = vec3(glm::min(product, static_cast<double>(kMaxRadiance)));
    const double largest = std::max({product.x, product.y, product.z});
    if (static_cast<float>(largest) > kMaxRadiance)
      repair(fmt::format("an emission of {:g} is clamped to {:g}", largest, kMaxRadiance));
  }

  void readIor(const tinygltf::Value& extension) {
    const double ior = numberOf(extension, "ior", 1.5);
    material_.ior = ior == 0.0 ? 0.0f : range(ior, 1.0f, kHuge, "ior");
  }

  void readSpecular(const tinygltf::Value& extension) {
    material_.specular = unit(numberOf(extension, "specularFactor", 1.0), "specularFactor");
    material_.specularTexture = texture(extension, "specularTexture");
    material_.specularColor =
        range(vec3Of(extension, "specularColorFactor", vec3(1.0f)), 0.0f, kHuge, "specularColorFactor");
    material_.specularColorTexture = texture(extension, "specularColorTexture");
  }

  void readVolume(const tinygltf::Value& extension) {
    material_.thickness = range(numberOf(extension, "thicknessFactor", 0.0), 0.0f, kHuge, "thicknessFactor");
    const double distance = numberOf(extension, "attenuationDistance", std::numeric_limits<double>::infinity());
    if (distance > 0.0) {
      material_.attenuationDistance = distanceOrInfinity(distance);
    } else {
      repair(fmt::format("attenuationDistance {} is not positive, replaced by infinity", distance));
    }
    // Zero would mean infinite absorption.
    material_.attenuationColor =
        glm::max(range(vec3Of(extension, "attenuationColor", vec3(1.0f)), 0.0f, 1.0f, "attenuationColor"), vec3(1e-6f));
  }

  void readVolumeScatter(const tinygltf::Value& extension) {
    material_.multiscatterColor =
        range(vec3Of(extension, "multiscatterColor", vec3(0.0f)), 0.0f, 1.0f, "multiscatterColor");
    material_.scatterAnisotropy =
        range(numberOf(extension, "scatterAnisotropy", 0.0), -0.999f, 0.999f, "scatterAnisotropy");
  }

  void readClearcoat(const tinygltf::Value& extension) {
    material_.clearcoat = unit(numberOf(extension, "clearcoatFactor", 0.0), "clearcoatFactor");
    material_.clearcoatTexture = texture(extension, "clearcoatTexture");
    material_.clearcoatRoughness =
        unit(numberOf(extension, "clearcoatRoughnessFactor", 0.0), "clearcoatRoughnessFactor");
    material_.clearcoatRoughnessTexture = texture(extension, "clearcoatRoughnessTexture");
    material_.clearcoatNormalTexture = texture(extension, "clearcoatNormalTexture");
    if (extension.Has("clearcoatNormalTexture"))
      material_.clearcoatNormalScale =
          static_cast<float>(numberOf(extension.Get("clearcoatNormalTexture"), "scale", 1.0));
  }

  void readDiffuseTransmission(const tinygltf::Value& extension) {
    material_.diffuseTransmission =
        unit(numberOf(extension, "diffuseTransmissionFactor", 0.0), "diffuseTransmissionFactor");
    material_.diffuseTransmissionTexture = texture(extension, "diffuseTransmissionTexture");
    material_.diffuseTransmissionColor = range(vec3Of(extension, "diffuseTransmissionColorFactor", vec3(1.0f)), 0.0f,
                                               1.0f, "diffuseTransmissionColorFactor");
    material_.diffuseTransmissionColorTexture = texture(extension, "diffuseTransmissionColorTexture");
  }

  void readAnisotropy(const tinygltf::Value& extension) {
    material_.anisotropy = unit(numberOf(extension, "anisotropyStrength", 0.0), "anisotropyStrength");
    material_.anisotropyRotation = static_cast<float>(numberOf(extension, "anisotropyRotation", 0.0));
    material_.anisotropyTexture = texture(extension, "anisotropyTexture");
  }

  void readIridescence(const tinygltf::Value& extension) {
    material_.iridescence = unit(numberOf(extension, "iridescenceFactor", 0.0), "iridescenceFactor");
    material_.iridescenceTexture = texture(extension, "iridescenceTexture");
    material_.iridescenceIor = range(numberOf(extension, "iridescenceIor", 1.3), 1.0f, kHuge, "iridescenceIor");
    material_.iridescenceThicknessMinimum =
        range(numberOf(extension, "iridescenceThicknessMinimum", 100.0), 0.0f, kHuge, "iridescenceThicknessMinimum");
    material_.iridescenceThicknessMaximum =
        range(numberOf(extension, "iridescenceThicknessMaximum", 400.0), 0.0f, kHuge, "iridescenceThicknessMaximum");
    material_.iridescenceThicknessTexture = texture(extension, "iridescenceThicknessTexture");
  }

  void readSheen(const tinygltf::Value& extension) {
    material_.sheenColor = range(vec3Of(extension, "sheenColorFactor", vec3(0.0f)), 0.0f, 1.0f, "sheenColorFactor");
    material_.sheenColorTexture = texture(extension, "sheenColorTexture");
    material_.sheenRoughness = unit(numberOf(extension, "sheenRoughnessFactor", 0.0), "sheenRoughnessFactor");
    material_.sheenRoughnessTexture = texture(extension, "sheenRoughnessTexture");
  }

  TextureUse texture(const tinygltf::Value& extension, const char* key) {
    if (!extension.Has(key)) return {};
    const tinygltf::Value& info = extension.Get(key);
    const tinygltf::Value* transform = info.Has("extensions") && info.Get("extensions").Has(kTextureTransform)
                                           ? &info.Get("extensions").Get(kTextureTransform)
                                           : nullptr;
    return texture(indexOf(info, "index"), indexOf(info, "texCoord", 0), transform, key);
  }

  template <class TextureInfo>
  TextureUse texture(const TextureInfo& info, const char* key) {
    return texture(info.index, info.texCoord, findExtension(info.extensions, kTextureTransform), key);
  }

  TextureUse texture(int index, int texCoord, const tinygltf::Value* transform, const char* key) {
    TextureUse use;
    if (index == kNone) return use;
    use.texture = textures_.use(index, fmt::format("{}/{}", location_, key));
    if (!use.used()) return use;
    if (transform) {
      texCoord = indexOf(*transform, "texCoord", texCoord);
      use.offset = vec2Of(*transform, "offset", use.offset);
      use.scale = vec2Of(*transform, "scale", use.scale);
      use.rotation = static_cast<float>(numberOf(*transform, "rotation", 0.0));
    }
    if (texCoord >= kMaxUvSets) {
      ignore(fmt::format("{} uses TEXCOORD_{}, which is not supported; replaced by TEXCOORD_0", key, texCoord));
      texCoord = 0;
    }
    use.uvSet = texCoord;
    return use;
  }

  // The conversion of KHR_materials_pbrSpecularGlossiness sets the values of these extensions.
  void ignoreForGlossiness(const char* extension) {
    ignore(fmt::format("{}: KHR_materials_pbrSpecularGlossiness has precedence", extension));
  }
  void ignore(const std::string& what) { report_.ignored.push_back(fmt::format("{}: {}", location_, what)); }
  void repair(const std::string& what) { report_.repaired.push_back(fmt::format("{}: {}", location_, what)); }

  float range(double value, float low, float high, const char* key) {
    const float clamped = std::clamp(static_cast<float>(value), low, high);
    if (static_cast<float>(value) != clamped)
      repair(fmt::format("{} {} is out of range, clamped to {}", key, value, clamped));
    return clamped;
  }
  vec3 range(const vec3& value, float low, float high, const char* key) {
    return {range(static_cast<double>(value.x), low, high, key), range(static_cast<double>(value.y), low, high, key),
            range(static_cast<double>(value.z), low, high, key)};
  }
  float unit(double value, const char* key) { return range(value, 0.0f, 1.0f, key); }

  const tinygltf::Material& from_;
  TextureTable& textures_;
  Report& report_;
  std::string location_;  // "/materials/3"
  Material material_;
};

}  // namespace

std::vector<Material> readMaterials(const Document& document, TextureTable& textures, Report& report) {
  std::vector<Material> materials;
  for (std::size_t i = 0; i < document.model.materials.size(); ++i)
    materials.push_back(MaterialReader(document, textures, report, i).read());
  return materials;
}

}  // namespace quintet::scene
