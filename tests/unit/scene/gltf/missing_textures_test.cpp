// SPDX-License-Identifier: Apache-2.0
// Textures whose images are missing or invalid: an error, or the factors of the material.
#include <gmock/gmock.h>

#include "base/error.h"
#include "base/file.h"
#include "scene/error_matcher.h"
#include "scene/gltf/gltf.h"
#include "scene/gltf_builder.h"
#include "scene/load.h"
#include "scene/model/validate.h"

namespace quintet::test {
namespace {

using scene::MissingTextures;
using testing::ElementsAre;

// A material with a base color texture from none.png, and one with an emissive texture that exists.
struct MissingBuilder : GltfBuilder {
  MissingBuilder() {
    addTriangle();
    add("images", {{"uri", "none.png"}});
    add("images", {{"bufferView", addView(tinyPng())}, {"mimeType", "image/png"}});
    for (int i = 0; i < 2; ++i) add("textures", {{"source", i}});
    add("materials",
        {{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1, 1}}, {"baseColorTexture", {{"index", 0}}}}},
         {"emissiveTexture", {{"index", 1}}}});
  }
};

scene::Scene load(const GltfBuilder& builder, const scene::LoadOptions& options) {
  const TempFolder folder;
  writeFile(folder / "a.glb", builder.glb());
  return scene::loadScene(folder / "a.glb", options);
}

TEST(GltfMissingTextures, AreErrorsThatNameTheRemedy) {
  try {
    load(MissingBuilder(), {});
    FAIL();
  } catch (const FileError& error) {
    EXPECT_EQ(error.location(), "/images/0/uri");
    EXPECT_EQ(error.remedy(), Remedy::omitTextures);
  }
}

TEST(GltfMissingTextures, LeaveTheFactors) {
  const scene::Scene scene = load(MissingBuilder(), {.missingTextures = MissingTextures::warn});
  EXPECT_NO_THROW(scene::validate(scene));
  const scene::Material& m = scene.materials[0];
  EXPECT_FALSE(m.baseColorTexture.used());
  EXPECT_EQ(m.baseColor, vec4(0.5f, 0.25f, 1, 1));
  EXPECT_TRUE(m.emissiveTexture.used());
  EXPECT_THAT(scene.report.ignored, ElementsAre(IsErrorAt("/images/0", "none.png does not exist")));
  std::size_t used = 0, ignored = 0;
  for (const scene::Feature& f : scene.report.features) {
    used += f.kind == "image" && f.use == scene::FeatureUse::used ? f.count : 0;
    ignored += f.kind == "image" && f.use == scene::FeatureUse::ignored ? f.count : 0;
  }
  EXPECT_EQ(used, 1u);
  EXPECT_EQ(ignored, 1u);
}

// The pixels of an image can be invalid although its header, which decides the shader code, is not.
TEST(GltfMissingTextures, IncludeInvalidImages) {
  MissingBuilder builder;
  builder.root["images"][0] = builder.root["images"][1];
  builder.root["images"][0]["bufferView"] = builder.addView(std::vector<std::byte>(60, std::byte{1}));
  const scene::Scene scene = load(builder, {.missingTextures = MissingTextures::warn});
  EXPECT_FALSE(scene.materials[0].baseColorTexture.used());
  EXPECT_TRUE(scene.materials[0].emissiveTexture.used());
}

// The roughness of a specular-glossiness texture is in a converted image, and its factor in the image, too.
TEST(GltfMissingTextures, RestoreTheGlossinessFactor) {
  MissingBuilder builder;
  builder.root["materials"][0] = {{"extensions",
                                   {{"KHR_materials_pbrSpecularGlossiness",
                                     {{"glossinessFactor", 0.75}, {"specularGlossinessTexture", {{"index", 0}}}}}}}};
  const scene::Material m = load(builder, {.missingTextures = MissingTextures::warn}).materials[0];
  EXPECT_FALSE(m.metallicRoughnessTexture.used());
  EXPECT_FALSE(m.specularColorTexture.used());
  EXPECT_EQ(m.roughness, 0.25f);
}

TEST(GltfMissingTextures, ApplyToSceneFiles) {
  const TempFolder folder;
  writeFile(folder / "a.scene.toml", std::string_view("[[material]]\nname = 'm'\nbase_color = [0.5, 0, 0]\n"
                                                      "base_color_texture = 'none.png'\n"));
  EXPECT_THROW(scene::loadScene(folder / "a.scene.toml"), FileError);
  const scene::Scene scene = scene::loadScene(folder / "a.scene.toml", {.missingTextures = MissingTextures::warn});
  EXPECT_FALSE(scene.materials.at(0).baseColorTexture.used());
  EXPECT_EQ(scene.materials.at(0).baseColor.r, 0.5f);
  EXPECT_THAT(scene.report.ignored, ElementsAre(IsErrorAt("line 4", "none.png")));
}

TEST(GltfMissingTextures, ApplyToInvalidImagesThatSeveralMaterialsUse) {
  const TempFolder folder;
  writeFile(folder / "broken.png", std::string_view("no image"));
  writeFile(folder / "a.scene.toml", std::string_view("[[material]]\nname = 'a'\nbase_color_texture = 'broken.png'\n"
                                                      "[[material]]\nname = 'b'\nemissive_texture = 'broken.png'\n"));
  const scene::Scene scene = scene::loadScene(folder / "a.scene.toml", {.missingTextures = MissingTextures::warn});
  EXPECT_TRUE(scene.images.empty());
  EXPECT_FALSE(scene.materials.at(0).baseColorTexture.used());
  EXPECT_FALSE(scene.materials.at(1).emissiveTexture.used());
  EXPECT_THAT(scene.report.ignored, ElementsAre(IsErrorAt("line 3", "broken.png"), IsErrorAt("line 6", "broken.png")));
}

}  // namespace
}  // namespace quintet::test
