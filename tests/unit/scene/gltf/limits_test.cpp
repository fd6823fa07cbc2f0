// SPDX-License-Identifier: Apache-2.0
// Numbers at the limits of float and of the renderer, and texels that are not finite.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "io/exr/exr.h"
#include "scene/error_matcher.h"
#include "scene/gltf/gltf.h"
#include "scene/gltf_builder.h"
#include "scene/model/limits.h"

namespace quintet::test {
namespace {

using scene::kMaxRadiance;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr float kSmallest = std::numeric_limits<float>::min(), kLargest = std::numeric_limits<float>::max();

GltfBuilder withMaterial(const Json& material) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.add("materials", material);
  builder.primitive()["material"] = 0;
  return builder;
}

// The JSON can have numbers that nlohmann::json does not write.
scene::Scene loadWith(const GltfBuilder& builder, const std::string& placeholder, const std::string& number) {
  std::string text = builder.gltf();
  const std::size_t at = text.find(placeholder);
  EXPECT_NE(at, std::string::npos);
  return loadText(text.replace(at, placeholder.size(), number));
}

Json volume(const Json& distance) {
  return {{"extensions",
           {{"KHR_materials_volume",
             {{"thicknessFactor", 1}, {"attenuationDistance", distance}, {"attenuationColor", {0.5, 0.5, 0.5}}}}}}};
}

TEST(GltfLimits, LargeAttenuationDistancesAreInfinite) {
  for (const char* number : {"1.7976931348623157e+308", "3.5e38", "1e400", "1E+999",
                             "99999999999999999999999999999999"
                             "999999999999999999999999999999999"}) {
    const scene::Scene scene = loadWith(withMaterial(volume("NUMBER")), "\"NUMBER\"", number);
    EXPECT_TRUE(std::isinf(scene.materials[0].attenuationDistance) && scene.materials[0].attenuationDistance > 0)
        << number;
    EXPECT_TRUE(scene.report.isExact()) << number;
  }
  EXPECT_EQ(withMaterial(volume(1e38)).load().materials[0].attenuationDistance, 1e38f);
}

TEST(GltfLimits, TinyNumbersDoNotBecomeZero) {
  EXPECT_EQ(withMaterial(volume(1e-320)).load().materials[0].attenuationDistance, kSmallest);
  EXPECT_EQ(withMaterial(volume(1e-42)).load().materials[0].attenuationDistance, kSmallest);
  GltfBuilder builder;
  builder.addTriangle();
  builder.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1e-320}, {"znear", 1e-320}}}});
  builder.add("cameras", {{"type", "orthographic"},
                          {"orthographic", {{"xmag", 1e-320}, {"ymag", 1e300}, {"znear", 0}, {"zfar", 1e300}}}});
  builder.add("nodes", {{"camera", 0}});
  builder.add("nodes", {{"camera", 1}});
  const scene::Scene scene = builder.load();
  EXPECT_EQ(scene.cameras.at(0).verticalFov, kSmallest);
  EXPECT_EQ(scene.cameras.at(1).orthographicHalfSize, vec2(kSmallest, kLargest));
  EXPECT_GT(scene.cameras.at(1).aspect, 0.0f);
}

TEST(GltfLimits, NumbersBeyondFloatAreItsLargest) {
  GltfBuilder builder = withMaterial({{"normalTexture", {{"index", 0}, {"scale", -1e300}}},
                                      {"alphaCutoff", 1e300},
                                      {"extensions", {{"KHR_materials_ior", {{"ior", 1e300}}}}}});
  const Json image = {{"bufferView", builder.addView(tinyPng())}, {"mimeType", "image/png"}};
  builder.add("images", image);
  builder.add("textures", {{"source", 0}});
  builder.primitive()["attributes"]["TEXCOORD_0"] = builder.addAccessor<float>({0, 0, 1, 0, 0, 1}, "VEC2");
  builder.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}, {"zfar", 1.7e308}}}});
  const scene::Scene scene = builder.load();
  EXPECT_EQ(scene.materials[0].normalScale, -kLargest);
  EXPECT_EQ(scene.materials[0].alphaCutoff, kLargest);
  EXPECT_EQ(scene.materials[0].ior, kLargest);
  EXPECT_THAT(scene.report.repaired, IsEmpty());
}

// Text that looks like a number stays.
TEST(GltfLimits, StringsKeepTheirDigits) {
  GltfBuilder builder = withMaterial(volume("NUMBER"));
  builder.root["materials"][0]["name"] = "1e400 \\\" 1e500";
  EXPECT_EQ(loadWith(builder, "\"NUMBER\"", "1e400").materials[0].name, "1e400 \\\" 1e500");
}

Json lights(const Json& light) { return {{"KHR_lights_punctual", {{"lights", Json::array({light})}}}}; }

scene::Scene withLight(const Json& light) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.root["extensions"] = lights(light);
  builder.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return builder.load();
}

TEST(GltfLimits, RangesOfLights) {
  EXPECT_TRUE(std::isinf(withLight({{"type", "point"}, {"range", 1.7e308}}).lights.at(0).range));
  EXPECT_TRUE(std::isinf(withLight({{"type", "spot"}, {"range", kLargest}}).lights.at(0).range));
  EXPECT_EQ(withLight({{"type", "point"}, {"range", 1e-320}}).lights.at(0).range, kSmallest);
  EXPECT_EQ(withLight({{"type", "point"}, {"range", 5}}).lights.at(0).range, 5.0f);
}

TEST(GltfLimits, ClampsTheIntensityOfLights) {
  scene::Scene scene = withLight({{"type", "directional"}, {"intensity", 1e30}, {"color", {1, 1e-20, 0}}});
  EXPECT_EQ(scene.lights.at(0).intensity, vec3(kMaxRadiance, 1e10f, 0));
  EXPECT_THAT(scene.report.repaired,
              ElementsAre(IsErrorAt("/extensions/KHR_lights_punctual/lights/0", "1e+30 is clamped to 1e+12")));
  scene = withLight({{"type", "point"}, {"intensity", 1e12}});
  EXPECT_EQ(scene.lights.at(0).intensity, vec3(kMaxRadiance));
  EXPECT_THAT(scene.report.repaired, IsEmpty());
}

TEST(GltfLimits, ClampsEmission) {
  const Json strength = {{"KHR_materials_emissive_strength", {{"emissiveStrength", 1e300}}}};
  scene::Scene scene = withMaterial({{"emissiveFactor", {1, 0, 1e-30}}, {"extensions", strength}}).load();
  EXPECT_EQ(scene.materials[0].emissive.x, kMaxRadiance);
  EXPECT_EQ(scene.materials[0].emissive.y, 0.0f);
  EXPECT_NEAR(scene.materials[0].emissive.z, 3.4e8f, 1e7f);
  EXPECT_THAT(scene.report.repaired, ElementsAre(IsErrorAt("/materials/0", "emission")));
  scene = withMaterial({{"emissiveFactor", {1e13, 0, 0}}}).load();
  EXPECT_EQ(scene.materials[0].emissive.x, kMaxRadiance);
  EXPECT_THAT(scene.report.repaired, ElementsAre(IsErrorAt("/materials/0", "emissiveFactor")));
}

// One node is too far away or too large: the others remain.
TEST(GltfLimits, IgnoresWhatIsBeyondTheLargestCoordinate) {
  GltfBuilder builder;
  builder.addTriangle();
  builder.add("nodes", {{"mesh", 0}, {"translation", {1e30, 0, 0}}});
  builder.add("nodes", {{"mesh", 0}, {"scale", {1, 1e20, 1}}});
  builder.add("nodes", {{"mesh", 0}, {"scale", {1e17, 1e17, 1e17}}});
  builder.root["extensions"] = lights({{"type", "point"}});
  builder.add("nodes", {{"translation", {0, -1e39, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  const scene::Scene scene = builder.load();
  EXPECT_EQ(scene.instances.size(), 2u);
  EXPECT_THAT(scene.lights, IsEmpty());
  EXPECT_THAT(scene.report.ignored, testing::UnorderedElementsAre(IsErrorAt("/nodes/1", "more than 1e+18 m"),
                                                                  IsErrorAt("/nodes/2", "1e+18 m"),
                                                                  IsErrorAt("/nodes/4", "camera or light")));
}

TEST(GltfLimits, DropsTrianglesBeyondTheLargestCoordinate) {
  GltfBuilder builder;
  builder.addMesh({{"attributes",
                    {{"POSITION", builder.addAccessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0,  //
                                                              0, 0, 0, 1e30f, 0, 0, 0, 1, 0},
                                                             "VEC3")}}}});
  const scene::Scene scene = builder.load();
  EXPECT_EQ(scene.meshes.at(0).geometries.at(0).triangles.size(), 1u);
  EXPECT_EQ(scene::worldBounds(scene).max, vec3(1, 1, 0));
}

// ---- Texels

std::vector<std::byte> floatImage(float bad) {
  io::ExrImage image{2, 2, {}};
  for (const char* name : {"R", "G", "B"})
    image.channels.push_back({name, io::ExrType::f32, std::vector<float>(4, 0.5f)});
  image.channels[1].samples[3] = bad;
  return io::encodeExr(image);
}

GltfBuilder withImage(float bad) {
  GltfBuilder builder = withMaterial({{"emissiveTexture", {{"index", 0}}}, {"emissiveFactor", {1, 1, 1}}});
  builder.add("images", {{"bufferView", builder.addView(floatImage(bad))}});
  builder.add("textures", {{"source", 0}});
  builder.primitive()["attributes"]["TEXCOORD_0"] = builder.addAccessor<float>({0, 0, 1, 0, 0, 1}, "VEC2");
  return builder;
}

TEST(GltfLimits, RepairsTexelsThatAreNotFinite) {
  const float kInf = std::numeric_limits<float>::infinity();
  const scene::Scene scene = withImage(kInf).load();
  EXPECT_EQ(scene.images.at(0).image.pixel<float>(1, 1)[1], kMaxRadiance);
  EXPECT_THAT(scene.report.repaired, ElementsAre(IsErrorAt("/images/0", "(1, 1)")));
  EXPECT_THAT(withImage(65504.0f).load().report.repaired, IsEmpty());
  const TempFolder folder;
  const std::filesystem::path file = folder / "a.glb";
  writeFile(file, withImage(1e20f).glb());
  scene::LoadOptions options;
  EXPECT_THAT(scene::loadGltf(file, options).report.repaired, ElementsAre(HasSubstr("1 pixel")));
  options.strict = true;
  EXPECT_THROW(scene::loadGltf(file, options), FileError);
}

// ---- Texture coordinates that a primitive lacks

GltfBuilder withTextures(const Json& material) {
  GltfBuilder builder = withMaterial(material);
  builder.add("images", {{"bufferView", builder.addView(tinyPng())}, {"mimeType", "image/png"}});
  builder.add("textures", {{"source", 0}});
  return builder;
}

TEST(GltfTextureCoordinates, TexturesWithoutThemAreIgnored) {
  GltfBuilder builder =
      withTextures({{"normalTexture", {{"index", 0}}},
                    {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}}}}});
  builder.primitive()["attributes"]["NORMAL"] = builder.addAccessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  builder.primitive()["attributes"]["TEXCOORD_0"] = builder.addAccessor<float>({0, 0, 1, 0, 0, 1}, "VEC2");
  const scene::Scene scene = builder.load();
  EXPECT_THAT(
      scene.report.repaired,
      ElementsAre(IsErrorAt("/meshes/0/primitives/0", "textures of /materials/0 that use TEXCOORD_1 are ignored")));
  const scene::Geometry& geometry = scene.meshes.at(0).geometries.at(0);
  const scene::Material& material = scene.materials.at(static_cast<std::size_t>(geometry.material));
  EXPECT_FALSE(material.baseColorTexture.used());
  EXPECT_TRUE(material.normalTexture.used());
  EXPECT_FALSE(geometry.tangents.empty());
  EXPECT_TRUE(scene.materials.at(0).baseColorTexture.used());  // for primitives that have the coordinates
}

TEST(GltfTextureCoordinates, OtherPrimitivesKeepTheTexture) {
  GltfBuilder builder = withTextures({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", 0}}}});
  const int uvs = builder.addAccessor<float>({0, 0, 1, 0, 0, 1}, "VEC2");
  builder.addMesh({{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", uvs}}}, {"material", 0}});
  builder.addMesh({{"attributes", {{"POSITION", 0}}}, {"material", 0}});
  const scene::Scene scene = builder.load();
  ASSERT_EQ(scene.meshes.size(), 3u);
  const auto used = [&](std::size_t mesh) {
    return scene.materials.at(static_cast<std::size_t>(scene.meshes[mesh].geometries[0].material))
        .emissiveTexture.used();
  };
  EXPECT_FALSE(used(0));
  EXPECT_TRUE(used(1));
  EXPECT_FALSE(used(2));
  EXPECT_EQ(scene.materials.size(), 2u);  // one copy for both
  EXPECT_EQ(scene.report.repaired.size(), 2u);
}

// KHR_texture_transform selects another set, and the occlusion texture has no effect.
TEST(GltfTextureCoordinates, FollowTheTransform) {
  const Json transform = {{"KHR_texture_transform", {{"texCoord", 0}}}};
  GltfBuilder builder = withTextures({{"emissiveTexture", {{"index", 0}, {"texCoord", 1}, {"extensions", transform}}},
                                      {"occlusionTexture", {{"index", 0}, {"texCoord", 1}}}});
  builder.primitive()["attributes"]["TEXCOORD_0"] = builder.addAccessor<float>({0, 0, 1, 0, 0, 1}, "VEC2");
  EXPECT_THAT(builder.load().report.repaired, IsEmpty());
  builder.root["materials"][0]["emissiveTexture"]["extensions"]["KHR_texture_transform"]["texCoord"] = 1;
  EXPECT_THAT(builder.load().report.repaired, ElementsAre(HasSubstr("TEXCOORD_1")));
}

// Without its texture, a specular-glossiness material has the roughness of its factor.
TEST(GltfTextureCoordinates, GlossinessFallsBackToItsFactor) {
  const GltfBuilder builder =
      withTextures({{"extensions",
                     {{"KHR_materials_pbrSpecularGlossiness",
                       {{"glossinessFactor", 0.75}, {"specularGlossinessTexture", {{"index", 0}}}}}}}});
  const scene::Scene scene = builder.load();
  const auto material = static_cast<std::size_t>(scene.meshes.at(0).geometries.at(0).material);
  EXPECT_EQ(scene.materials.at(0).roughness, 1.0f);
  EXPECT_EQ(scene.materials.at(material).roughness, 0.25f);
}

}  // namespace
}  // namespace quintet::test
