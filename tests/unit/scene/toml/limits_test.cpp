// SPDX-License-Identifier: Apache-2.0
// Numbers of scene files at the limits of float and of the renderer, and images that are not finite.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "base/file.h"
#include "io/exr/exr.h"
#include "scene/load.h"
#include "scene/model/limits.h"
#include "scene/toml/parse.h"
#include "temp_folder.h"

namespace quintet::test {
namespace {

using scene::kMaxRadiance;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(SceneTomlLimits, LargeDistancesAreInfinite) {
  const scene::Scene scene = parse(
      "[[material]]\nname = 'a'\nattenuation_distance = 1e300\n[[material]]\nname = 'b'\nattenuation_distance = inf\n"
      "[[material]]\nname = 'c'\nattenuation_distance = 1e-320\n"
      "[[light]]\ntype = 'point'\nposition = [0, 1, 0]\nrange = 1.7976931348623157e308\n");
  EXPECT_TRUE(std::isinf(scene.materials.at(0).attenuationDistance));
  EXPECT_TRUE(std::isinf(scene.materials.at(1).attenuationDistance));
  EXPECT_EQ(scene.materials.at(2).attenuationDistance, std::numeric_limits<float>::min());
  EXPECT_TRUE(std::isinf(scene.lights.at(0).range));
}

TEST(SceneTomlLimits, RejectsRadianceAboveTheLargest) {
  EXPECT_THAT(errorOfToml("[[light]]\ntype = 'point'\nposition = [0, 1, 0]\nintensity = 1e30\n"),
              HasSubstr("line 1: the intensity of [[light]] is too large; at most 1e+12"));
  EXPECT_THAT(errorOfToml("[[light]]\ntype = 'directional'\ndirection = [0, 1, 0]\ncolor = [1e38, 1e38, 1e38]\n"
                          "intensity = 1e38\n"),
              HasSubstr("too large"));
  EXPECT_THAT(errorOfToml("[[material]]\nname = 'a'\nemissive = [1, 0, 0]\nemissive_strength = 1e13\n"),
              HasSubstr("the emission of [[material]] 'a' is too large; at most 1e+12"));
  EXPECT_THAT(errorOfToml("[environment]\ncolor = [1, 1e20, 1]\n"), HasSubstr("line 2: 'color'"));
  EXPECT_EQ(parse("[environment]\ncolor = [1, 1e12, 1]\n").environment.constant.y, kMaxRadiance);
}

TEST(SceneTomlLimits, RejectsPositionsBeyondTheLargest) {
  EXPECT_THAT(errorOfToml("[[light]]\ntype = 'point'\nposition = [0, 1e30, 0]\n"), HasSubstr("1e+18"));
  EXPECT_THAT(errorOfToml("[[mesh]]\nshape = 'quad'\n[[camera]]\nname = 'a'\nlook_from = [1e30, 0, 0]\n"
                          "look_at = [0, 0, 0]\n"),
              HasSubstr("is too far away: its coordinates can be at most 1e+18"));
}

TEST(SceneTomlLimits, RepairsTexelsThatAreNotFinite) {
  const TempFolder folder;
  io::ExrImage image{2, 1, {}};
  for (const char* name : {"R", "G", "B"}) image.channels.push_back({name, io::ExrType::f32, {1.0f, 1.0f}});
  image.channels[2].samples[1] = std::numeric_limits<float>::infinity();
  writeFile(folder / "sky.exr", io::encodeExr(image));
  writeFile(folder / "a.scene.toml",
            "[environment]\nimage = 'sky.exr'\n[[material]]\nname = 'a'\nemissive = [1, 1, 1]\n"
            "emissive_texture = 'sky.exr'\n");
  scene::LoadOptions options;
  const scene::Scene scene = scene::loadScene(folder / "a.scene.toml", options);
  EXPECT_EQ(scene.environment.image.pixel<float>(1, 0)[2], kMaxRadiance);
  EXPECT_EQ(scene.images.at(0).image.pixel<float>(1, 0)[2], kMaxRadiance);
  EXPECT_THAT(scene.report.repaired, testing::Each(testing::StartsWith("sky.exr: 1 pixel is")));
  EXPECT_THAT(scene.report.repaired, testing::Each(HasSubstr("(1, 0)")));
  options.strict = true;
  EXPECT_THROW(scene::loadScene(folder / "a.scene.toml", options), FileError);
}

// The meshes of shapes have one set of texture coordinates.
TEST(SceneTomlTextureCoordinates, TexturesWithoutThemAreIgnored) {
  const TempFolder folder;
  io::ExrImage image{
      1, 1, {{"R", io::ExrType::f32, {0.5f}}, {"G", io::ExrType::f32, {0.5f}}, {"B", io::ExrType::f32, {0.5f}}}};
  writeFile(folder / "a.exr", io::encodeExr(image));
  writeFile(folder / "a.scene.toml",
            "[[material]]\nname = 'a'\nbase_color_texture = { image = 'a.exr', uv_set = 1 }\n"
            "[[mesh]]\nname = 'square'\nshape = 'quad'\nmaterial = 'a'\n");
  const scene::Scene scene = scene::loadScene(folder / "a.scene.toml", {});
  EXPECT_THAT(scene.report.repaired,
              testing::ElementsAre(HasSubstr("mesh 'square': the textures of material 'a' that use set 1")));
  const int material = scene.meshes.at(0).geometries.at(0).material;
  EXPECT_FALSE(scene.materials.at(static_cast<std::size_t>(material)).baseColorTexture.used());
}

}  // namespace
}  // namespace quintet::test
