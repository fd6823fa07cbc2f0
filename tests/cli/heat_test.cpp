// SPDX-License-Identifier: Apache-2.0
// Heat maps as images with false colors, and as layers.
#include <gmock/gmock.h>

#include "fixtures.h"
#include "io/codec.h"
#include "render/tone_map/false_color.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;

class Heat : public CliTest {};

TEST_F(Heat, AnImageHasFalseColorsAndALegend) {
  const RunResult result = quintet({"run", "normals", "scene.gltf", "--size", "32x24", "--spp", "2", "--output",
                                    "heat_rays", "-o", "rays.png", "--json", "-q"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["toneMap"], "viridis");
  const io::Image image = readImage("rays.png");
  EXPECT_EQ(image.width, 32u);
  EXPECT_EQ(image.height, 24u + render::kLegendRows);
  // One ray per sample in each pixel: the largest value everywhere.
  const vec3 brightest = 255.0f * render::viridis(1.0f);
  for (const std::uint32_t x : {0u, 31u})
    for (glm::length_t c = 0; c < 3; ++c)
      EXPECT_NEAR(image.pixel<std::uint8_t>(x, 12)[static_cast<std::size_t>(c)], brightest[c], 0.5f);
}

TEST_F(Heat, ExposureAndToneMapApply) {
  const auto top = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"run", "normals", "scene.gltf", "--size",    "8x4", "--spp",
                                       "1",   "-q",      "--output",   "heat_rays", "-o",  "rays.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(quintet(arguments).status, 0);
    return readImage("rays.png");
  };
  // The largest color stands for twice the largest value.
  const io::Image half = top({"--exposure", "-1"});
  EXPECT_NEAR(half.pixel<std::uint8_t>(2, 2)[1], 255.0f * render::viridis(0.5f).y, 0.5f);
  const io::Image gray = top({"--tonemap", "linear"});
  EXPECT_EQ(gray.height, 4u);
  EXPECT_EQ(gray.pixel<std::uint8_t>(2, 2)[0], 255);
}

TEST_F(Heat, LayersKeepTheImage) {
  const std::vector<std::string> render{"render", "scene.gltf", "--size", "32x24", "--spp", "4", "-q", "-o"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = render;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return quintet(arguments);
  };
  ASSERT_EQ(with({"plain.exr"}).status, 0);
  const RunResult result = with({"heat.exr", "--aov", "heat_rays,heat_bounces,heat_any_hit,normal"});
  ASSERT_EQ(result.status, 0) << result.err;
  const io::Image plain = readImage("plain.exr"), heat = readImage("heat.exr");
  EXPECT_TRUE(plain.data == heat.data);
  EXPECT_THAT(quintet({"info", "heat.exr"}).out, HasSubstr("heat_bounces"));
}

TEST_F(Heat, NamesAreListedAndSuggested) {
  EXPECT_THAT(quintet({"render", "scene.gltf", "--aov", "list"}).out, HasSubstr("heat_intersection"));
  EXPECT_THAT(quintet({"run", "normals", "--help"}).out, HasSubstr("heat maps heat_time, heat_rays"));
  expectError(quintet({"run", "normals", "--output", "heat_ray", "-o", "a.png"}), 2, {"'heat_ray'", "heat_rays"});
  expectError(quintet({"render", "scene.gltf", "-o", "a.exr", "--aov", "heat_tim"}), 2, {"'heat_tim'", "heat_time"});
}

}  // namespace
}  // namespace quintet::test
