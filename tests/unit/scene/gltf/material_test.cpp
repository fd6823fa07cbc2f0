// SPDX-License-Identifier: Apache-2.0
// Materials, textures, samplers and images.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "base/error.h"
#include "base/file.h"
#include "io/basis_lz_builder.h"
#include "io/basis_samples.h"
#include "io/codec.h"
#include "io/ktx2_builder.h"
#include "scene/error_matcher.h"
#include "scene/gltf/gltf.h"
#include "scene/gltf_builder.h"
#include "scene/model/content_hash.h"
#include "scene/model/material_textures.h"
#include "scene/model/validate.h"

namespace quintet::test {
namespace {

using scene::Material;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

Material loadMaterial(const Json& material) {
  GltfBuilder builder;
  builder.add("materials", material);
  return builder.load().materials.at(0);
}

std::string errorOfMaterial(const Json& material) {
  GltfBuilder builder;
  builder.add("materials", material);
  return errorOf(builder);
}

Json extension(const char* name, const Json& object) { return {{"extensions", {{name, object}}}}; }

TEST(GltfMaterial, HasTheDefaultsOfTheSpecification) {
  const Material loaded = loadMaterial(Json::object()), expected;
  EXPECT_EQ(loaded.baseColor, expected.baseColor);
  EXPECT_EQ(loaded.metallic, 1.0f);
  EXPECT_EQ(loaded.roughness, 1.0f);
  EXPECT_EQ(loaded.emissive, vec3(0));
  EXPECT_EQ(loaded.alphaMode, scene::AlphaMode::opaque);
  EXPECT_EQ(loaded.alphaCutoff, 0.5f);
  EXPECT_FALSE(loaded.doubleSided);
  EXPECT_FALSE(loaded.unlit);
  EXPECT_EQ(loaded.ior, 1.5f);
  EXPECT_EQ(loaded.transmission, 0.0f);
  EXPECT_EQ(loaded.thickness, 0.0f);
  EXPECT_TRUE(std::isinf(loaded.attenuationDistance));
  EXPECT_EQ(loaded.attenuationColor, vec3(1));
  EXPECT_EQ(loaded.specular, 1.0f);
  EXPECT_EQ(loaded.clearcoat, 0.0f);
  EXPECT_FALSE(loaded.baseColorTexture.used());
}

TEST(GltfMaterial, ReadsCoreFactors) {
  const Material m =
      loadMaterial({{"name", "paint"},
                    {"pbrMetallicRoughness",
                     {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}},
                    {"emissiveFactor", {1, 0.5, 2}},
                    {"alphaMode", "MASK"},
                    {"alphaCutoff", 0.75},
                    {"doubleSided", true}});
  EXPECT_EQ(m.name, "paint");
  EXPECT_EQ(m.baseColor, vec4(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.emissive, vec3(1, 0.5f, 2));
  EXPECT_EQ(m.alphaMode, scene::AlphaMode::mask);
  EXPECT_EQ(m.alphaCutoff, 0.75f);
  EXPECT_TRUE(m.doubleSided);
  EXPECT_EQ(loadMaterial({{"alphaMode", "BLEND"}}).alphaMode, scene::AlphaMode::blend);
}

TEST(GltfMaterial, ReadsExtensions) {
  Material m = loadMaterial({{"emissiveFactor", {1, 0.5, 0}},
                             {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 10}}}}}});
  EXPECT_EQ(m.emissive, vec3(10, 5, 0));
  EXPECT_EQ(loadMaterial(extension("KHR_materials_ior", {{"ior", 1.33}})).ior, 1.33f);
  EXPECT_EQ(loadMaterial(extension("KHR_materials_ior", {{"ior", 0}})).ior, 0.0f);
  EXPECT_EQ(loadMaterial(extension("KHR_materials_ior", Json::object())).ior, 1.5f);
  EXPECT_EQ(loadMaterial(extension("KHR_materials_transmission", {{"transmissionFactor", 0.75}})).transmission, 0.75f);
  m = loadMaterial(
      extension("KHR_materials_volume",
                {{"thicknessFactor", 2}, {"attenuationDistance", 0.5}, {"attenuationColor", {0.5, 0, 1}}}));
  EXPECT_EQ(m.thickness, 2.0f);
  EXPECT_EQ(m.attenuationDistance, 0.5f);
  EXPECT_EQ(m.attenuationColor, vec3(0.5f, 1e-6f, 1));
  EXPECT_TRUE(loadMaterial(extension("KHR_materials_unlit", Json::object())).unlit);
  m = loadMaterial(extension("KHR_materials_specular", {{"specularFactor", 0.5}, {"specularColorFactor", {2, 1, 0}}}));
  EXPECT_EQ(m.specular, 0.5f);
  EXPECT_EQ(m.specularColor, vec3(2, 1, 0));
  m = loadMaterial(extension("KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"clearcoatRoughnessFactor", 0.1}}));
  EXPECT_EQ(m.clearcoat, 1.0f);
  EXPECT_EQ(m.clearcoatRoughness, 0.1f);
  m = loadMaterial(
      extension("KHR_materials_sheen", {{"sheenColorFactor", {0.5, 1, 0.25}}, {"sheenRoughnessFactor", 0.75}}));
  EXPECT_EQ(m.sheenColor, vec3(0.5f, 1, 0.25f));
  EXPECT_EQ(m.sheenRoughness, 0.75f);
  m = loadMaterial(
      extension("KHR_materials_diffuse_transmission",
                {{"diffuseTransmissionFactor", 0.25}, {"diffuseTransmissionColorFactor", {1, 0.5, 0.25}}}));
  EXPECT_EQ(m.diffuseTransmission, 0.25f);
  EXPECT_EQ(m.diffuseTransmissionColor, vec3(1, 0.5f, 0.25f));
  m = loadMaterial(extension("KHR_materials_anisotropy", {{"anisotropyStrength", 0.75}, {"anisotropyRotation", -2.5}}));
  EXPECT_EQ(m.anisotropy, 0.75f);
  EXPECT_EQ(m.anisotropyRotation, -2.5f);
  m = loadMaterial(extension("KHR_materials_iridescence", {{"iridescenceFactor", 0.5},
                                                           {"iridescenceIor", 1.75},
                                                           {"iridescenceThicknessMinimum", 50},
                                                           {"iridescenceThicknessMaximum", 800}}));
  EXPECT_EQ(m.iridescence, 0.5f);
  EXPECT_EQ(m.iridescenceIor, 1.75f);
  EXPECT_EQ(m.iridescenceThicknessMinimum, 50.0f);
  EXPECT_EQ(m.iridescenceThicknessMaximum, 800.0f);
  m = loadMaterial(
      extension("KHR_materials_volume_scatter", {{"multiscatterColor", {0.5, 1, 0.25}}, {"scatterAnisotropy", -0.5}}));
  EXPECT_EQ(m.multiscatterColor, vec3(0.5f, 1, 0.25f));
  EXPECT_EQ(m.scatterAnisotropy, -0.5f);
  m = loadMaterial(extension("KHR_materials_dispersion", {{"dispersion", 1.5}}));
  EXPECT_EQ(m.dispersion, 1.5f);
}

// Extras can be anything: only a finite number counts, and everything else is reported as unused.
TEST(GltfMaterial, ReadsThePriorityFromExtras) {
  for (const auto& [extras, priority, unused] :
       {std::tuple(Json{{"dielectric_priority", 2.5}}, 2.5f, 0u),
        std::tuple(Json{{"dielectric_priority", -1}}, -1.0f, 0u),
        std::tuple(Json{{"dielectric_priority", 3}, {"author", "me"}}, 3.0f, 1u),
        std::tuple(Json{{"dielectric_priority", "high"}}, 0.0f, 1u),
        std::tuple(Json{{"dielectric_priority", 1e300}}, 0.0f, 1u), std::tuple(Json("text"), 0.0f, 1u),
        std::tuple(Json(nullptr), 0.0f, 1u)}) {
    GltfBuilder builder;
    builder.add("materials", {{"extras", extras}});
    const scene::Scene scene = builder.load();
    EXPECT_EQ(scene.materials[0].dielectricPriority, priority) << extras;
    EXPECT_EQ(scene.report.ignored.size() + scene.report.repaired.size(), 0u) << extras;
    EXPECT_EQ(std::ranges::count(scene.report.features, "extras", &scene::Feature::name), unused) << extras;
  }
}

// Values of the specification.
TEST(GltfMaterial, HasTheDefaultsOfExtensions) {
  const Material m = loadMaterial(extension("KHR_materials_iridescence", Json::object()));
  EXPECT_EQ(m.iridescence, 0.0f);
  EXPECT_EQ(m.iridescenceIor, 1.3f);
  EXPECT_EQ(m.iridescenceThicknessMinimum, 100.0f);
  EXPECT_EQ(m.iridescenceThicknessMaximum, 400.0f);
  EXPECT_EQ(m.multiscatterColor, vec3(0.0f));
  EXPECT_EQ(m.scatterAnisotropy, 0.0f);
  EXPECT_EQ(m.anisotropy, 0.0f);
  EXPECT_EQ(m.dispersion, 0.0f);
}

// A material out of range is repaired, and the report says so.
TEST(GltfMaterial, ClampsFactorsOfExtensions) {
  GltfBuilder builder;
  Json material = extension("KHR_materials_anisotropy", {{"anisotropyStrength", 2}});
  material["extensions"]["KHR_materials_dispersion"] = {{"dispersion", -1}};
  material["extensions"]["KHR_materials_iridescence"] = {{"iridescenceIor", 0.5}};
  builder.add("materials", material);
  const scene::Scene scene = builder.load();
  EXPECT_EQ(scene.materials[0].anisotropy, 1.0f);
  EXPECT_EQ(scene.materials[0].dispersion, 0.0f);
  EXPECT_EQ(scene.materials[0].iridescenceIor, 1.0f);
  EXPECT_THAT(scene.report.repaired,
              ElementsAre(IsErrorAt("/materials/0", "anisotropyStrength"), IsErrorAt("/materials/0", "iridescenceIor"),
                          IsErrorAt("/materials/0", "dispersion")));
}

// The extension states: c_diff = diffuse (1 - max(specular)), F0 = specular, alpha = (1 - glossiness)².
TEST(GltfMaterial, ConvertsSpecularGlossiness) {
  GltfBuilder builder;
  Json material = extension(
      "KHR_materials_pbrSpecularGlossiness",
      {{"diffuseFactor", {0.1, 0.2, 0.3, 0.4}}, {"specularFactor", {0.5, 0.25, 1}}, {"glossinessFactor", 0.75}});
  material["pbrMetallicRoughness"] = {{"baseColorFactor", {1, 0, 0, 1}}, {"metallicFactor", 1}};
  builder.add("materials", material);
  const scene::Scene scene = builder.load();
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.baseColor, vec4(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_EQ(m.metallic, 0.0f);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.ior, 0.0f);
  EXPECT_EQ(m.specular, 1.0f);
  EXPECT_EQ(m.specularColor, vec3(0.5f, 0.25f, 1));
  EXPECT_TRUE(scene.report.isExact());
  const auto listed =
      std::ranges::find(scene.report.features, "KHR_materials_pbrSpecularGlossiness", &scene::Feature::name);
  ASSERT_NE(listed, scene.report.features.end());
  EXPECT_EQ(listed->use, scene::FeatureUse::used);
  EXPECT_THAT(listed->reason, testing::HasSubstr("converted"));
  const Material defaults = loadMaterial(extension("KHR_materials_pbrSpecularGlossiness", Json::object()));
  EXPECT_EQ(defaults.baseColor, vec4(1));
  EXPECT_EQ(defaults.specularColor, vec3(1));
  EXPECT_EQ(defaults.roughness, 0.0f);
}

// The conversion sets the ior and the specular factors.
TEST(GltfMaterial, IgnoresExtensionsThatSpecularGlossinessReplaces) {
  GltfBuilder builder;
  builder.add("materials",
              {{"extensions",
                {{"KHR_materials_pbrSpecularGlossiness", {{"specularFactor", {0.5, 0.25, 1}}}},
                 {"KHR_materials_ior", {{"ior", 1.8}}},
                 {"KHR_materials_specular", {{"specularFactor", 0.5}, {"specularColorFactor", {1, 1, 0}}}}}}});
  const scene::Scene scene = builder.load();
  EXPECT_EQ(scene.materials[0].ior, 0.0f);
  EXPECT_EQ(scene.materials[0].specular, 1.0f);
  EXPECT_EQ(scene.materials[0].specularColor, vec3(0.5f, 0.25f, 1));
  EXPECT_THAT(scene.report.ignored, ElementsAre(IsErrorAt("/materials/0", "KHR_materials_ior"),
                                                IsErrorAt("/materials/0", "KHR_materials_specular")));
}

TEST(GltfMaterial, ClampsFactors) {
  GltfBuilder builder;
  builder.add("materials",
              {{"pbrMetallicRoughness", {{"metallicFactor", 1.5}, {"roughnessFactor", -1}}},
               {"extensions",
                {{"KHR_materials_ior", {{"ior", 0.5}}}, {"KHR_materials_volume", {{"attenuationDistance", 0}}}}}});
  const scene::Scene scene = builder.load();
  EXPECT_EQ(scene.materials[0].metallic, 1.0f);
  EXPECT_EQ(scene.materials[0].roughness, 0.0f);
  EXPECT_EQ(scene.materials[0].ior, 1.0f);
  EXPECT_TRUE(std::isinf(scene.materials[0].attenuationDistance));
  EXPECT_THAT(
      scene.report.repaired,
      ElementsAre(IsErrorAt("/materials/0", "metallicFactor 1.5"), IsErrorAt("/materials/0", "roughnessFactor -1"),
                  IsErrorAt("/materials/0", "ior 0.5"), IsErrorAt("/materials/0", "attenuationDistance 0")));
}

TEST(GltfMaterial, RejectsWrongTypes) {
  EXPECT_THAT(errorOfMaterial({{"alphaMode", "GLOW"}}), IsErrorAt("/materials/0/alphaMode", "GLOW"));
  EXPECT_THAT(errorOfMaterial({{"emissiveFactor", {1, 2}}}), IsErrorAt("/materials/0/emissiveFactor", "3 numbers"));
  EXPECT_THAT(errorOfMaterial({{"doubleSided", 1}}), IsErrorAt("/materials/0/doubleSided", "true or false"));
  EXPECT_THAT(errorOfMaterial({{"normalTexture", {{"index", 0}}}}),
              IsErrorAt("/materials/0/normalTexture/index", "texture 0"));
  EXPECT_THAT(errorOfMaterial({{"normalTexture", Json::object()}}), IsErrorAt("/materials/0/normalTexture", "index"));
  EXPECT_THAT(errorOfMaterial(extension("KHR_materials_transmission", {{"transmissionTexture", {{"index", 3}}}})),
              IsErrorAt("/materials/0/extensions/KHR_materials_transmission/transmissionTexture/index", "texture 3"));
  EXPECT_THAT(errorOfMaterial(extension("KHR_materials_ior", {{"ior", "glass"}})),
              IsErrorAt("/materials/0/extensions/KHR_materials_ior/ior", "number"));
}

// One image and one texture.
struct TextureBuilder : GltfBuilder {
  TextureBuilder() {
    add("images", {{"bufferView", addView(tinyPng())}, {"mimeType", "image/png"}});
    add("textures", {{"source", 0}, {"name", "tiles"}});
  }
  Json& use() {
    if (!root.contains("materials"))
      add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    return root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  }
};

TEST(GltfTexture, ReadsImagesInBufferViews) {
  TextureBuilder builder;
  builder.use();
  const scene::Scene scene = builder.load();
  EXPECT_EQ(scene.materials[0].baseColorTexture.texture, 0);
  EXPECT_EQ(scene.textures.at(0).name, "tiles");
  EXPECT_EQ(scene.textures[0].image, 0);
  EXPECT_EQ(scene.textures[0].sampler, scene::Sampler{});
  EXPECT_EQ(scene.images.at(0).name, "scene.glb: /images/0");
  EXPECT_EQ(scene.images[0].image.width, 2u);
  EXPECT_EQ(std::to_integer<int>(scene.images[0].image.data[0]), 255);
}

TEST(GltfTexture, DecodesOnlyUsedImages) {
  TextureBuilder builder;
  builder.add("images", {{"bufferView", builder.addView<int>({1, 2, 3})}});
  builder.add("textures", {{"source", 1}});
  EXPECT_TRUE(builder.load().images.empty());
  builder.use()["index"] = 1;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/images/1", ""));
}

TEST(GltfTexture, ReadsTextureTransforms) {
  TextureBuilder builder;
  builder.use()["texCoord"] = 1;
  builder.use()["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.5, 0.25}}, {"scale", {2, 3}}, {"rotation", 1.5}};
  scene::TextureUse use = builder.load().materials[0].baseColorTexture;
  EXPECT_EQ(use.uvSet, 1);
  EXPECT_EQ(use.offset, vec2(0.5f, 0.25f));
  EXPECT_EQ(use.scale, vec2(2, 3));
  EXPECT_EQ(use.rotation, 1.5f);
  builder.use()["extensions"]["KHR_texture_transform"]["texCoord"] = 0;
  EXPECT_EQ(builder.load().materials[0].baseColorTexture.uvSet, 0);
}

TEST(GltfTexture, ReadsTexturesOfExtensions) {
  TextureBuilder builder;
  builder.add("materials", extension("KHR_materials_clearcoat",
                                     {{"clearcoatNormalTexture",
                                       {{"index", 0},
                                        {"scale", 0.5},
                                        {"texCoord", 1},
                                        {"extensions", {{"KHR_texture_transform", {{"scale", {4, 4}}}}}}}}}));
  const Material m = builder.load().materials[0];
  EXPECT_EQ(m.clearcoatNormalTexture.texture, 0);
  EXPECT_EQ(m.clearcoatNormalTexture.uvSet, 1);
  EXPECT_EQ(m.clearcoatNormalTexture.scale, vec2(4));
  EXPECT_EQ(m.clearcoatNormalScale, 0.5f);
}

// The JSON pointer of each texture inside of a material.
struct TextureCase {
  const char* pointer;
  scene::TextureUse Material::*use;
};
constexpr TextureCase kTextureCases[] = {
    {"/pbrMetallicRoughness/baseColorTexture", &Material::baseColorTexture},
    {"/pbrMetallicRoughness/metallicRoughnessTexture", &Material::metallicRoughnessTexture},
    {"/normalTexture", &Material::normalTexture},
    {"/occlusionTexture", &Material::occlusionTexture},
    {"/emissiveTexture", &Material::emissiveTexture},
    {"/extensions/KHR_materials_transmission/transmissionTexture", &Material::transmissionTexture},
    {"/extensions/KHR_materials_specular/specularTexture", &Material::specularTexture},
    {"/extensions/KHR_materials_specular/specularColorTexture", &Material::specularColorTexture},
    {"/extensions/KHR_materials_clearcoat/clearcoatTexture", &Material::clearcoatTexture},
    {"/extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture", &Material::clearcoatRoughnessTexture},
    {"/extensions/KHR_materials_clearcoat/clearcoatNormalTexture", &Material::clearcoatNormalTexture},
    {"/extensions/KHR_materials_sheen/sheenColorTexture", &Material::sheenColorTexture},
    {"/extensions/KHR_materials_sheen/sheenRoughnessTexture", &Material::sheenRoughnessTexture},
    {"/extensions/KHR_materials_anisotropy/anisotropyTexture", &Material::anisotropyTexture},
    {"/extensions/KHR_materials_iridescence/iridescenceTexture", &Material::iridescenceTexture},
    {"/extensions/KHR_materials_iridescence/iridescenceThicknessTexture", &Material::iridescenceThicknessTexture},
    {"/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionTexture",
     &Material::diffuseTransmissionTexture},
    {"/extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture",
     &Material::diffuseTransmissionColorTexture},
    {"/extensions/KHR_materials_pbrSpecularGlossiness/diffuseTexture", &Material::baseColorTexture},
    {"/extensions/KHR_materials_pbrSpecularGlossiness/specularGlossinessTexture", &Material::specularColorTexture},
};

// Each texture has its own set of texture coordinates and its own transform.
TEST(GltfTexture, ReadsSetsAndTransformsOfEveryTexture) {
  for (const scene::MaterialTexture& texture : scene::kMaterialTextures)
    EXPECT_TRUE(std::ranges::any_of(kTextureCases, [&](const TextureCase& c) { return c.use == texture.use; }))
        << "a texture of a material is not in kTextureCases";
  for (const TextureCase& c : kTextureCases) {
    TextureBuilder builder;
    Json material;
    material[Json::json_pointer(c.pointer)] = {
        {"index", 0},
        {"texCoord", 0},
        {"extensions",
         {{"KHR_texture_transform",
           {{"offset", {0.5, 0.25}}, {"rotation", 0.75}, {"scale", {2, 3}}, {"texCoord", 1}}}}}};
    builder.add("materials", material);
    const scene::Scene scene = builder.load();
    const scene::TextureUse& use = scene.materials[0].*c.use;
    EXPECT_TRUE(use.used()) << c.pointer;
    EXPECT_EQ(use.uvSet, 1) << c.pointer;
    EXPECT_EQ(use.offset, vec2(0.5f, 0.25f)) << c.pointer;
    EXPECT_EQ(use.rotation, 0.75f) << c.pointer;
    EXPECT_EQ(use.scale, vec2(2, 3)) << c.pointer;
    EXPECT_TRUE(scene.report.ignored.empty()) << c.pointer;
  }
}

TEST(GltfTexture, ReadsTexturesOfSheen) {
  TextureBuilder builder;
  builder.add("materials",
              extension("KHR_materials_sheen", {{"sheenColorTexture", {{"index", 0}}},
                                                {"sheenRoughnessTexture", {{"index", 0}, {"texCoord", 1}}}}));
  const Material m = builder.load().materials[0];
  EXPECT_EQ(m.sheenColorTexture.texture, 0);
  EXPECT_EQ(m.sheenColorTexture.uvSet, 0);
  EXPECT_EQ(m.sheenRoughnessTexture.texture, 0);
  EXPECT_EQ(m.sheenRoughnessTexture.uvSet, 1);
}

TEST(GltfTexture, ReadsTexturesOfDiffuseTransmission) {
  TextureBuilder builder;
  builder.add("materials", extension("KHR_materials_diffuse_transmission",
                                     {{"diffuseTransmissionTexture", {{"index", 0}}},
                                      {"diffuseTransmissionColorTexture", {{"index", 0}, {"texCoord", 1}}}}));
  const Material m = builder.load().materials[0];
  EXPECT_EQ(m.diffuseTransmissionTexture.texture, 0);
  EXPECT_EQ(m.diffuseTransmissionTexture.uvSet, 0);
  EXPECT_EQ(m.diffuseTransmissionColorTexture.texture, 0);
  EXPECT_EQ(m.diffuseTransmissionColorTexture.uvSet, 1);
}

// Two uses of one texture, but one line in the report.
TEST(GltfTexture, ReportsTheSpecularGlossinessTextureOnce) {
  TextureBuilder builder;
  builder.add("materials", extension("KHR_materials_pbrSpecularGlossiness",
                                     {{"specularGlossinessTexture", {{"index", 0}, {"texCoord", 2}}}}));
  const scene::Scene scene = builder.load();
  EXPECT_TRUE(scene.materials[0].metallicRoughnessTexture.used());
  EXPECT_THAT(scene.report.ignored, ElementsAre(IsErrorAt("/materials/0", "TEXCOORD_2")));
}

TEST(GltfTexture, ReadsTexturesOfAnisotropyAndIridescence) {
  TextureBuilder builder;
  const Json turned = {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"rotation", 0.5}, {"texCoord", 1}}}}}};
  Json material = extension("KHR_materials_anisotropy", {{"anisotropyTexture", turned}});
  material["extensions"]["KHR_materials_iridescence"] = {{"iridescenceTexture", {{"index", 0}}},
                                                         {"iridescenceThicknessTexture", turned}};
  builder.add("materials", material);
  const Material m = builder.load().materials[0];
  for (const scene::TextureUse& use : {m.anisotropyTexture, m.iridescenceThicknessTexture}) {
    EXPECT_EQ(use.texture, 0);
    EXPECT_EQ(use.uvSet, 1);
    EXPECT_EQ(use.rotation, 0.5f);
  }
  EXPECT_EQ(m.iridescenceTexture.texture, 0);
  EXPECT_EQ(m.iridescenceTexture.uvSet, 0);
}

// Glossiness is in alpha, and its factor scales it. The same image gives the specular color.
TEST(GltfTexture, ConvertsGlossinessToRoughness) {
  io::Image image = io::makeImage(2, 1, 4, io::PixelType::u8, io::ColorEncoding::sRgb);
  const std::uint8_t texels[] = {10, 20, 30, 0, 40, 50, 60, 255};
  std::ranges::copy(texels, image.samples<std::uint8_t>().begin());
  GltfBuilder builder;
  builder.add("images", {{"bufferView", builder.addView(io::encodePng(image))}, {"mimeType", "image/png"}});
  builder.add("textures", {{"source", 0}});
  builder.add("materials",
              extension("KHR_materials_pbrSpecularGlossiness",
                        {{"glossinessFactor", 0.6}, {"specularGlossinessTexture", {{"index", 0}, {"texCoord", 1}}}}));
  const scene::Scene scene = builder.load();
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.roughness, 1.0f);
  EXPECT_EQ(m.metallic, 0.0f);
  EXPECT_EQ(m.metallicRoughnessTexture.uvSet, 1);
  const auto imageOf = [&](const scene::TextureUse& use) {
    const std::size_t texture = static_cast<std::size_t>(use.texture);
    return scene.images.at(static_cast<std::size_t>(scene.textures.at(texture).image)).image;
  };
  const io::Image roughness = imageOf(m.metallicRoughnessTexture), specular = imageOf(m.specularColorTexture);
  EXPECT_EQ(roughness.pixel<std::uint8_t>(0, 0)[1], 255);
  EXPECT_EQ(roughness.pixel<std::uint8_t>(1, 0)[1], 102);
  EXPECT_EQ(specular.pixel<std::uint8_t>(1, 0)[1], 50);
}

TEST(GltfTexture, ReplacesUnsupportedTextureCoordinateSets) {
  TextureBuilder builder;
  builder.use()["texCoord"] = 2;
  const scene::Scene scene = builder.load();
  EXPECT_EQ(scene.materials[0].baseColorTexture.uvSet, 0);
  EXPECT_THAT(scene.report.ignored, ElementsAre(IsErrorAt("/materials/0", "TEXCOORD_2")));
}

TEST(GltfTexture, ReadsSamplers) {
  TextureBuilder builder;
  builder.use();
  builder.add("samplers", {{"magFilter", 9728}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 33648}});
  builder.root["textures"][0]["sampler"] = 0;
  const scene::Sampler expected{scene::Wrap::clampToEdge, scene::Wrap::mirroredRepeat, scene::Filter::nearest};
  EXPECT_EQ(builder.load().textures[0].sampler, expected);
  builder.root["samplers"][0]["wrapS"] = 1;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/samplers/0/wrapS", "1"));
  builder.root["textures"][0]["sampler"] = 1;
  builder.root["samplers"][0]["wrapS"] = 10497;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/textures/0/sampler", "sampler 1"));
}

TEST(GltfTexture, PrefersWebp) {
  TextureBuilder builder;
  builder.use();
  builder.add("images", {{"bufferView", builder.root["images"][0]["bufferView"]}, {"name", "second"}});
  builder.root["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 1;
  EXPECT_EQ(builder.load().images.at(0).name, "scene.glb: /images/1");
  builder.root["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 2;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/textures/0/extensions/EXT_texture_webp/source", "image 2"));
}

TEST(GltfTexture, ReadsBasisUniversal) {
  for (const std::vector<std::byte>& file :
       {io::test::etc1sFile(), io::test::etc1sAlphaFile(), io::test::uastcFile()}) {
    const io::Image expected = io::decodeImage(file, "a");
    TextureBuilder builder;
    builder.use();
    builder.root["images"][0] = {{"bufferView", builder.addView(file)}, {"mimeType", "image/ktx2"}};
    builder.root["textures"][0] = {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}};
    builder.root["extensionsUsed"] = builder.root["extensionsRequired"] = {"KHR_texture_basisu"};
    const scene::Scene scene = builder.load();
    EXPECT_TRUE(scene.report.isExact());
    EXPECT_THAT(scene.report.extensionsUsed, testing::Contains("KHR_texture_basisu"));
    ASSERT_TRUE(scene.materials[0].baseColorTexture.used());
    EXPECT_EQ(scene.images.at(0).image.data, expected.data);
    // The same as a separate file. It has precedence over the fallback, which does not exist.
    const TempFolder folder;
    writeFile(folder / "a b.ktx2", file);
    builder.root["images"][0] = {{"uri", "a%20b.ktx2"}};
    builder.add("images", {{"uri", "none.png"}});
    builder.root["textures"][0]["source"] = 1;
    writeFile(folder / "scene.glb", builder.glb());
    EXPECT_EQ(scene::loadGltf(folder / "scene.glb").images.at(0).image.data, expected.data);
  }
}

// The codebooks are far behind what is read of a separate file to choose between it and its fallback.
TEST(GltfTexture, ReadsLargeBasisUniversalInsteadOfTheFallback) {
  std::mt19937 random(1);
  io::test::BasisLzImage image{.width = 40, .height = 40};
  image.fill(random, 50, 50, 1);
  io::test::Ktx2 file = image.file(random, {0});
  file.addKey("padding", std::string(100000, 'a'));
  TextureBuilder builder;
  builder.use();
  builder.add("images", {{"uri", "a.ktx2"}});
  builder.root["textures"][0]["extensions"]["KHR_texture_basisu"]["source"] = 1;
  const TempFolder folder;
  writeFile(folder / "a.ktx2", file.build());
  writeFile(folder / "scene.glb", builder.glb());
  const scene::Scene scene = scene::loadGltf(folder / "scene.glb");
  EXPECT_TRUE(scene.report.isExact());
  EXPECT_EQ(scene.images.at(0).image.width, 40u);
}

// A color model that is not supported: UASTC HDR.
std::vector<std::byte> hdrFile() {
  io::test::Ktx2 file{.format = 0, .level = std::vector<std::byte>(16)};
  file.describe(167, {0});
  return file.build();
}

TEST(GltfTexture, UsesTheFallbackOfBasisUniversal) {
  TextureBuilder builder;
  builder.use();
  builder.add("images", {{"bufferView", builder.addView(hdrFile())}, {"mimeType", "image/ktx2"}});
  builder.root["textures"][0]["extensions"]["KHR_texture_basisu"]["source"] = 1;
  builder.root["extensionsRequired"] = {"KHR_texture_basisu"};
  scene::Scene scene = builder.load();
  EXPECT_TRUE(scene.materials[0].baseColorTexture.used());
  EXPECT_EQ(scene.images.at(0).name, "scene.glb: /images/0");
  EXPECT_THAT(scene.report.ignored,
              ElementsAre(IsErrorAt("/textures/0/extensions/KHR_texture_basisu", "167 is not supported; replaced")));
  // Without a fallback, it is an error.
  builder.root["textures"][0].erase("source");
  EXPECT_THAT(errorOf(builder), IsErrorAt("/images/1", "color model 167"));
  // An image that can be read has precedence.
  builder.root["textures"][0]["source"] = 1;
  builder.root["textures"][0]["extensions"]["KHR_texture_basisu"]["source"] = 0;
  scene = builder.load();
  EXPECT_TRUE(scene.report.isExact());
  EXPECT_EQ(scene.images.at(0).name, "scene.glb: /images/0");
  // A broken one without a fallback is an error.
  builder.root["textures"][0].erase("source");
  builder.root["textures"][0]["extensions"]["KHR_texture_basisu"]["source"] = 1;
  builder.binary[builder.root["bufferViews"][1]["byteOffset"].get<std::size_t>()] = std::byte{0};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/images/1", "not a supported image"));
}

// The memory limit is enough for the file and its pixels, but not for the file twice.
TEST(GltfTexture, ReadsSeparateKtx2FilesOnce) {
  io::test::Ktx2 image{.width = 512, .height = 512, .level = std::vector<std::byte>(1 << 20)};
  TextureBuilder builder;
  builder.use();
  builder.root["images"][0] = {{"uri", "a.ktx2"}};
  builder.root["textures"][0] = {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}};
  const TempFolder folder;
  writeFile(folder / "a.ktx2", image.build());
  writeFile(folder / "scene.glb", builder.glb());
  const scene::LoadOptions options{.maxMemory = 5u << 19};
  EXPECT_EQ(scene::loadGltf(folder / "scene.glb", options).images.at(0).image.width, 512u);
  // Its header decides whether a fallback is used.
  builder.add("images", {{"uri", "b.ktx2"}});
  builder.root["textures"][0]["source"] = 1;
  writeFile(folder / "scene.glb", builder.glb());
  writeFile(folder / "b.ktx2", image.build());
  EXPECT_EQ(scene::loadGltf(folder / "scene.glb", options).report.isExact(), true);
  image.format = 200;
  writeFile(folder / "a.ktx2", image.build());
  EXPECT_THAT(scene::loadGltf(folder / "scene.glb", options).report.ignored,
              ElementsAre(IsErrorAt("/textures/0/extensions/KHR_texture_basisu", "format 200")));
  std::filesystem::remove(folder / "b.ktx2");
  std::filesystem::remove(folder / "a.ktx2");
  EXPECT_THROW(scene::loadGltf(folder / "scene.glb", options), FileError);
}

// The same for data URIs. The limit is enough for the file, its JSON, the URI and the pixels, but not for the URI twice.
TEST(GltfTexture, DecodesDataUrisOfKtx2Once) {
  const io::test::Ktx2 image{.width = 512, .height = 512, .level = std::vector<std::byte>(1 << 20)};
  TextureBuilder builder;
  builder.use();
  const std::string uri = "data:image/ktx2;base64," + base64(image.build());
  builder.root["images"][0] = {{"uri", uri}};
  builder.root["textures"][0] = {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}};
  const TempFolder folder;
  writeFile(folder / "scene.glb", builder.glb());
  const std::size_t once = 17 * builder.glb().size() + uri.size() + (1 << 20);
  const auto load = [&](std::size_t limit) { return scene::loadGltf(folder / "scene.glb", {.maxMemory = limit}); };
  EXPECT_EQ(load(once + uri.size() / 2).images.at(0).image.width, 512u);
  EXPECT_THROW(load(once - uri.size() / 2), MemoryError);
}

TEST(GltfTexture, IgnoresTexturesWithoutASupportedImage) {
  TextureBuilder builder;
  builder.use();
  builder.root["textures"][0] = {{"extensions", {{"EXT_texture_video", {{"source", 0}}}}}};
  const scene::Scene scene = builder.load();
  EXPECT_FALSE(scene.materials[0].baseColorTexture.used());
  EXPECT_THAT(scene.report.ignored, testing::Contains(IsErrorAt("/materials/0/baseColorTexture", "texture 0")));
}

TEST(GltfImage, ReportsInvalidImagesAsErrorsOfTheScene) {
  TextureBuilder builder;
  builder.use();
  builder.root["bufferViews"][0]["byteLength"] = 40;
  EXPECT_THAT(errorOf(builder), IsErrorAt("/images/0", ""));
  builder.root["images"][0] = {{"uri", "data:image/png;base64,AAAA"}};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/images/0", ""));
  builder.root["images"][0] = {{"uri", "none.png"}};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/images/0/uri", "none.png"));
  builder.root["images"][0] = Json::object();
  EXPECT_THAT(errorOf(builder), IsErrorAt("/images/0", "uri"));
  builder.root["images"][0] = {{"uri", "a.png"}, {"bufferView", 0}};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/images/0", "uri"));
  builder.root["images"][0] = {{"bufferView", 4}};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/images/0/bufferView", "buffer view 4"));
}

// The memory of an encoded image is returned once it is decoded, unless another image uses the same bytes.
TEST(GltfImage, ReadsImagesThatShareBytes) {
  io::Image noise = io::makeImage(256, 256, 3, io::PixelType::u8, io::ColorEncoding::sRgb);
  std::uint32_t state = 1;
  for (std::byte& value : noise.data) value = static_cast<std::byte>((state = state * 1664525u + 1013904223u) >> 24);
  GltfBuilder builder;
  const std::vector<std::byte> png = io::encodePng(noise);
  ASSERT_GT(png.size(), 100'000u);
  const int alone = builder.addView(png), shared = builder.addView(png);
  // The same bytes, and some before them.
  Json wider = builder.root["bufferViews"][1];
  wider["byteOffset"] = wider["byteOffset"].get<std::uint64_t>() - 8;
  wider["byteLength"] = png.size() + 8;
  builder.add("bufferViews", wider);
  for (int i = 0; i < 12; ++i) {
    builder.add("images", {{"bufferView", i == 0 ? alone : shared}, {"mimeType", "image/png"}});
    builder.add("textures", {{"source", i}});
    builder.add("materials", {{"emissiveTexture", {{"index", i}}}});
  }
  const scene::Scene scene = builder.load();
  ASSERT_EQ(scene.images.size(), 12u);
  for (const scene::NamedImage& image : scene.images) EXPECT_TRUE(image.image.data == noise.data) << image.name;
}

// Two materials with an image each, of 3 and 4 channels.
struct TwoImages : TextureBuilder {
  TwoImages() {
    use();
    const io::Image veil = io::makeImage(3, 5, 4, io::PixelType::u8, io::ColorEncoding::sRgb);
    add("images", {{"bufferView", addView(io::encodePng(veil))}, {"mimeType", "image/png"}});
    add("textures", {{"source", 1}});
    add("materials", {{"emissiveTexture", {{"index", 1}}}});
  }
};

TEST(GltfImage, IsDescribedBeforeItIsDecoded) {
  const TempFolder folder;
  writeFile(folder / "scene.glb", TwoImages().glb());
  scene::PendingScene pending = scene::beginLoadingGltf(folder / "scene.glb");
  EXPECT_TRUE(pending.described());
  const scene::Scene& partial = pending.scene();
  EXPECT_EQ(partial.materials.size(), 2u);
  EXPECT_EQ(partial.textures.size(), 2u);
  ASSERT_EQ(partial.images.size(), 2u);
  EXPECT_EQ(partial.images[0].image.channels, 3u);
  EXPECT_EQ(partial.images[1].image.channels, 4u);
  EXPECT_EQ(partial.images[1].image.height, 5u);
  for (const scene::NamedImage& image : partial.images) EXPECT_TRUE(image.image.data.empty());
  EXPECT_EQ(partial.seconds.images, 0.0);

  const scene::Scene scene = std::move(pending).finish();
  EXPECT_NO_THROW(scene::validate(scene));
  EXPECT_EQ(scene.images[1].image.data.size(), 3u * 5 * 4);
  EXPECT_GT(scene.seconds.document, 0.0);
  EXPECT_GT(scene.seconds.images, 0.0);
  EXPECT_EQ(scene::contentHash(scene), scene::contentHash(scene::loadGltf(folder / "scene.glb")));
}

TEST(GltfImage, IsNotDescribedInAnExternalFile) {
  TwoImages builder;
  builder.root["images"][0] = {{"uri", "tiles.png"}};
  const TempFolder folder;
  writeFile(folder / "tiles.png", tinyPng());
  writeFile(folder / "scene.glb", builder.glb());
  scene::PendingScene pending = scene::beginLoadingGltf(folder / "scene.glb");
  EXPECT_FALSE(pending.described());
  const scene::Scene scene = std::move(pending).finish();
  ASSERT_EQ(scene.images.size(), 2u);
  EXPECT_EQ(scene.images[0].image.channels, 3u);
  EXPECT_EQ(scene.images[1].image.channels, 4u);
}

TEST(GltfImage, InvalidDataIsReportedWhenItIsDecoded) {
  TwoImages builder;
  builder.root["bufferViews"][1]["byteLength"] = 60;  // the header is complete, the pixels are not
  const TempFolder folder;
  writeFile(folder / "scene.glb", builder.glb());
  scene::PendingScene pending = scene::beginLoadingGltf(folder / "scene.glb");
  EXPECT_TRUE(pending.described());
  EXPECT_THROW(std::move(pending).finish(), FileError);
}

TEST(GltfImage, ReadsExternalFiles) {
  TextureBuilder builder;
  builder.use();
  builder.root["images"][0] = {{"uri", "my%20tiles.png"}};
  const TempFolder folder;
  writeFile(folder / "my tiles.png", tinyPng());
  writeFile(folder / "scene.glb", builder.glb());
  const scene::Scene scene = scene::loadGltf(folder / "scene.glb");
  EXPECT_EQ(scene.images.at(0).name, (folder / "my tiles.png").string());
  writeFile(folder / "my tiles.png", "not an image");
  try {
    scene::loadGltf(folder / "scene.glb");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_EQ(error.file(), folder / "scene.glb");
    EXPECT_EQ(error.location(), "/images/0");
    EXPECT_THAT(error.problem(), StartsWith("my tiles.png: "));
  }
}

}  // namespace
}  // namespace quintet::test
