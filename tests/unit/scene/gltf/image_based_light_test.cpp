// SPDX-License-Identifier: Apache-2.0
// EXT_lights_image_based: the cube map becomes the environment.
#include "scene/gltf/image_based_light.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/file.h"
#include "io/codec.h"
#include "scene/error_matcher.h"
#include "scene/gltf_builder.h"
#include "scene/load.h"

namespace quintet::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

using Faces = std::array<io::Image, 6>;

const std::array<vec3, 6> kAxes{vec3(1, 0, 0),  vec3(-1, 0, 0), vec3(0, 1, 0),
                                vec3(0, -1, 0), vec3(0, 0, 1),  vec3(0, 0, -1)};

// The pixel of the environment in a direction, by the convention of scene::Environment.
vec3 radianceTo(const io::Image& image, const vec3& direction) {
  const vec3 d = glm::normalize(direction);
  const float u = std::atan2(d.z, d.x) / (2.0f * kPi) + 0.5f, v = std::acos(d.y) / kPi;
  const auto at = [](float value, std::uint32_t size) {
    return std::min(static_cast<std::uint32_t>(value * static_cast<float>(size)), size - 1);
  };
  const auto pixel = image.pixel<float>(at(u, image.width), at(v, image.height));
  return {pixel[0], pixel[1], pixel[2]};
}

Faces makeFaces(std::uint32_t size, auto color) {
  Faces faces;
  for (std::size_t f = 0; f < 6; ++f) {
    faces[f] = io::makeImage(size, size, 3, io::PixelType::f32, io::ColorEncoding::linear);
    for (std::uint32_t y = 0; y < size; ++y)
      for (std::uint32_t x = 0; x < size; ++x) {
        const vec3 c = color(f, x, y);
        for (glm::length_t k = 0; k < 3; ++k) faces[f].pixel<float>(x, y)[static_cast<std::size_t>(k)] = c[k];
      }
  }
  return faces;
}

TEST(ImageBasedLight, PutsEachFaceInItsDirection) {
  const Faces faces = makeFaces(8, [](std::size_t f, auto, auto) { return vec3(static_cast<float>(f), 1, 2); });
  const io::Image image = scene::equirectangularFromCube(faces, quat(1, 0, 0, 0));
  EXPECT_EQ(image.width, 32u);
  EXPECT_EQ(image.height, 16u);
  for (std::size_t f = 0; f < 6; ++f)
    EXPECT_LT(glm::distance(radianceTo(image, kAxes[f]), vec3(static_cast<float>(f), 1, 2)), 1e-5f) << f;
}

// An observer in the center who looks at a face with the given up direction has +x of the image on the right.
TEST(ImageBasedLight, ShowsTheFacesFromInside) {
  const std::array<vec3, 6> up{vec3(0, 1, 0), vec3(0, 1, 0), vec3(0, 0, -1),
                               vec3(0, 0, 1), vec3(0, 1, 0), vec3(0, 1, 0)};
  const Faces faces = makeFaces(64, [](std::size_t f, auto x, auto y) { return vec3(static_cast<float>(f), x, y); });
  const io::Image image = scene::equirectangularFromCube(faces, quat(1, 0, 0, 0));
  for (std::size_t f = 0; f < 6; ++f) {
    const vec3 right = glm::cross(kAxes[f], up[f]);
    for (const vec2& p : {vec2(0.0f), vec2(0.7f, 0.2f), vec2(-0.5f, -0.8f)}) {
      const vec3 found = radianceTo(image, kAxes[f] + p.x * right - p.y * up[f]);
      EXPECT_LT(glm::distance(found, vec3(static_cast<float>(f), 32.0f * (1.0f + p.x), 32.0f * (1.0f + p.y))), 2.0f)
          << f << " at " << p.x << ' ' << p.y;
    }
  }
}

// A rotation by 90° about y moves light from +z to +x.
TEST(ImageBasedLight, RotatesTheLight) {
  const Faces faces = makeFaces(8, [](std::size_t f, auto, auto) { return vec3(f == 4 ? 1.0f : 0.0f); });
  const io::Image image = scene::equirectangularFromCube(faces, glm::angleAxis(kPi / 2.0f, vec3(0, 1, 0)));
  EXPECT_NEAR(radianceTo(image, {1, 0, 0}).x, 1.0f, 1e-6f);
  EXPECT_NEAR(radianceTo(image, {0, 0, 1}).x, 0.0f, 1e-6f);
}

// --- files -----------------------------------------------------------------------------------------------------------

std::vector<std::byte> png(std::uint32_t width, std::uint32_t height, std::vector<std::uint8_t> color) {
  io::Image image = io::makeImage(width, height, static_cast<std::uint32_t>(color.size()), io::PixelType::u8,
                                  io::ColorEncoding::sRgb);
  const auto samples = image.samples<std::uint8_t>();
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = color[i % color.size()];
  return io::encodePng(image);
}

// A light with two levels: RGBD faces of 4 x 4 pixels, and LDR faces of 2 x 2.
struct ImageBasedLightBuilder : GltfBuilder {
  explicit ImageBasedLightBuilder(const std::vector<std::byte>& face = png(4, 4, {255, 188, 0, 51})) {
    addTriangle();
    add("images", {{"bufferView", addView(face)}});
    add("images", {{"bufferView", addView(png(2, 2, {10, 20, 30}))}});
    root["extensions"]["EXT_lights_image_based"]["lights"] = {{{"name", "sky"},
                                                               {"intensity", 0.5},
                                                               {"irradianceCoefficients", Json::array()},
                                                               {"specularImageSize", 4},
                                                               {"specularImages", {Json(6, 0), Json(6, 1)}}}};
    root["scenes"] = {{{"nodes", {0}}, {"extensions", {{"EXT_lights_image_based", {{"light", 0}}}}}}};
  }
  Json& light() { return root["extensions"]["EXT_lights_image_based"]["lights"][0]; }
};

// 188 is 0.503 in linear light; the alpha 51/255 multiplies by 5.
TEST(ImageBasedLight, BecomesTheEnvironment) {
  ImageBasedLightBuilder builder;
  builder.root["extensionsRequired"] = {"EXT_lights_image_based"};
  const scene::Scene scene = builder.load();
  const scene::Environment& e = scene.environment;
  ASSERT_TRUE(e.present);
  EXPECT_EQ(e.name, "sky");
  EXPECT_EQ(e.intensity, 0.5f);
  EXPECT_EQ(e.image.width, 16u);
  EXPECT_LT(glm::distance(radianceTo(e.image, {1, 2, 3}), vec3(5.0f, 2.5145f, 0.0f)), 1e-3f);
  EXPECT_THAT(scene.report.repaired,
              ElementsAre(IsErrorAt("/extensions/EXT_lights_image_based/lights/0", "16 x 8 pixels")));
  EXPECT_THAT(scene.report.ignored, testing::IsEmpty());
  std::vector<std::string> unused;
  for (const scene::Feature& f : scene.report.features)
    if (f.use == scene::FeatureUse::unused) unused.push_back(f.location);
  EXPECT_THAT(unused, testing::UnorderedElementsAre("/images/1", HasSubstr("irradianceCoefficients"),
                                                    HasSubstr("specularImageSize")));
}

TEST(ImageBasedLight, AcceptsImagesWithoutAlpha) {
  EXPECT_LT(
      glm::distance(radianceTo(ImageBasedLightBuilder(png(2, 2, {255, 188, 0})).load().environment.image, {1, 0, 0}),
                    vec3(1.0f, 0.5029f, 0.0f)),
      1e-3f);
}

TEST(ImageBasedLight, IsNotUsedByOtherScenes) {
  ImageBasedLightBuilder builder;
  builder.root["scenes"][0].erase("extensions");
  const scene::Scene scene = builder.load();
  EXPECT_FALSE(scene.environment.present);
  EXPECT_TRUE(scene.report.isExact());
}

TEST(ImageBasedLight, RepairsItsValues) {
  ImageBasedLightBuilder builder;
  builder.light()["intensity"] = -1;
  builder.light()["rotation"] = {0, 0, 0, 0};
  const scene::Scene scene = builder.load();
  EXPECT_EQ(scene.environment.intensity, 0.0f);
  EXPECT_EQ(scene.report.repaired.size(), 3u);
}

TEST(ImageBasedLight, NamesTheLocationOfErrors) {
  EXPECT_THAT(errorOf(ImageBasedLightBuilder(png(4, 2, {1, 2, 3}))),
              IsErrorAt("/extensions/EXT_lights_image_based/lights/0/specularImages/0/0", "4 x 2 pixels"));
  ImageBasedLightBuilder builder;
  builder.light()["specularImages"][0][5] = 1;
  EXPECT_THAT(errorOf(builder),
              IsErrorAt("/extensions/EXT_lights_image_based/lights/0/specularImages/0/5", "same size"));
  builder.light()["specularImages"] = {Json(5, 0)};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/extensions/EXT_lights_image_based/lights/0/specularImages", "6 images"));
  builder.light()["specularImages"] = {{2}};
  EXPECT_THAT(errorOf(builder),
              IsErrorAt("/extensions/EXT_lights_image_based/lights/0/specularImages/0/0", "does not exist"));
  builder.light()["specularImages"] = {1};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/extensions/EXT_lights_image_based/lights/0/specularImages/0", "array"));
}

TEST(ImageBasedLight, IsOmittedWithMissingImages) {
  ImageBasedLightBuilder builder;
  builder.root["images"][0] = {{"uri", "none.png"}};
  EXPECT_THAT(errorOf(builder), IsErrorAt("/images/0/uri", "none.png"));
  const TempFolder folder;
  writeFile(folder / "a.glb", builder.glb());
  const scene::Scene scene = scene::loadScene(folder / "a.glb", {.missingTextures = scene::MissingTextures::warn});
  EXPECT_FALSE(scene.environment.present);
  EXPECT_THAT(scene.report.ignored,
              Contains(IsErrorAt("/extensions/EXT_lights_image_based/lights/0", "without this light")));
}

// Of a scene file, if it has no [environment].
TEST(ImageBasedLight, LightsSceneFiles) {
  const TempFolder folder;
  writeFile(folder / "a.glb", ImageBasedLightBuilder().glb());
  const auto load = [&](const std::string& text) {
    writeFile(folder / "a.scene.toml", std::as_bytes(std::span(text)));
    return scene::loadScene(folder / "a.scene.toml").environment;
  };
  const std::string file = "[[file]]\nname = \"a\"\npath = \"a.glb\"\n";
  EXPECT_EQ(load(file).name, "sky");
  EXPECT_FALSE(load(file + "lights = false\n").present);
  EXPECT_FALSE(load(file + "place = false\n").present);
  EXPECT_EQ(load(file + "[environment]\ncolor = [1, 2, 3]\n").constant, vec3(1, 2, 3));
}

}  // namespace
}  // namespace quintet::test
