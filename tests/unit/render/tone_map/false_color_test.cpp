// SPDX-License-Identifier: Apache-2.0
// False colors: the color map, its scale, and the legend.
#include "render/tone_map/false_color.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/color.h"

namespace quintet::render {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

io::Image imageOf(std::uint32_t width, const std::vector<float>& values) {
  io::Image image = io::makeImage(width, static_cast<std::uint32_t>(values.size()) / width, 4, io::PixelType::f32,
                                  io::ColorEncoding::linear);
  for (std::size_t i = 0; i < values.size(); ++i) image.samples<float>()[4 * i] = values[i];
  return image;
}

TEST(Viridis, HasThePublishedColors) {
  EXPECT_EQ(viridis(0.0f), vec3(0.267004f, 0.004874f, 0.329415f));
  EXPECT_EQ(viridis(1.0f), vec3(0.993248f, 0.906157f, 0.143936f));
  // Entries 64 and 128 of the table of 256 colors, which are not among the interpolated points.
  const vec3 quarter(0.229739f, 0.322361f, 0.545706f), three(0.369214f, 0.788888f, 0.382914f);
  for (glm::length_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(viridis(0.25f)[c], quarter[c], 0.02f);
    EXPECT_NEAR(viridis(0.75f)[c], three[c], 0.02f);
  }
}

TEST(Viridis, ClampsAndBrightensSteadily) {
  EXPECT_EQ(viridis(-1.0f), viridis(0.0f));
  EXPECT_EQ(viridis(kNan), viridis(0.0f));
  EXPECT_EQ(viridis(7.0f), viridis(1.0f));
  const auto brightness = [](float t) {
    const vec3 color = viridis(t);
    return 0.2126f * io::linearFromSrgb(color.x) + 0.7152f * io::linearFromSrgb(color.y) +
           0.0722f * io::linearFromSrgb(color.z);
  };
  for (int i = 1; i <= 100; ++i)
    EXPECT_GT(brightness(static_cast<float>(i) / 100.0f), brightness(static_cast<float>(i - 1) / 100.0f)) << i;
}

TEST(FalseColor, ScaleIsTheLargestFiniteValue) {
  const FalseColorScale scale = falseColorScale(imageOf(2, {1.0f, 3.0f, kInfinite, kNan}), 0.0f);
  EXPECT_EQ(scale.maximum, 3.0f);
  EXPECT_FALSE(scale.exceeded);
  EXPECT_EQ(falseColorScale(imageOf(2, {-1.0f, 0.0f}), 0.0f).maximum, 0.0f);
  EXPECT_EQ(falseColorScale(imageOf(1, {kNan}), 0.0f).maximum, 0.0f);
}

TEST(FalseColor, ExposureDividesTheScale) {
  const FalseColorScale scale = falseColorScale(imageOf(2, {2.0f, 3.0f}), 1.0f);
  EXPECT_EQ(scale.maximum, 1.5f);
  EXPECT_TRUE(scale.exceeded);
  EXPECT_FALSE(falseColorScale(imageOf(2, {2.0f, 3.0f}), -1.0f).exceeded);
}

TEST(FalseColor, TheScaleIsFinite) {
  const io::Image image = imageOf(80, std::vector<float>(80, 1e30f));
  const FalseColorScale scale = falseColorScale(image, -100.0f);
  EXPECT_EQ(scale.maximum, std::numeric_limits<float>::max());
  EXPECT_EQ(falseColor(image, {.scale = scale}).height, 1 + kLegendRows);
}

TEST(FalseColor, OutliersDoNotDecideTheScale) {
  std::vector<float> values(1000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  EXPECT_EQ(falseColorScale(imageOf(1000, values), 0.0f).maximum, 999.0f);
  values[0] = 1e6f;
  const FalseColorScale scale = falseColorScale(imageOf(1000, values), 0.0f);
  EXPECT_EQ(scale.maximum, 991.0f) << "the 99th percentile";
  EXPECT_TRUE(scale.exceeded);
  // Most pixels are 0: the rare values are what the image shows.
  EXPECT_EQ(falseColorScale(imageOf(4, {0.0f, 0.0f, 0.0f, 5.0f}), 0.0f).maximum, 5.0f);
}

TEST(FalseColor, TheScaleIsThePercentileOnlyBelowHalfOfTheLargest) {
  std::vector<float> values(200, 0.5f);
  values[7] = 2.0f;
  values[8] = 1.0f;  // the 99th percentile: 198 values are smaller
  FalseColorScale scale = falseColorScale(imageOf(200, values), 0.0f);
  EXPECT_EQ(scale.maximum, 2.0f);
  EXPECT_FALSE(scale.exceeded);
  values[8] = std::nextafter(1.0f, 0.0f);
  scale = falseColorScale(imageOf(200, values), 0.0f);
  EXPECT_EQ(scale.maximum, values[8]);
  EXPECT_TRUE(scale.exceeded);
}

TEST(FalseColor, ColorsTheFirstChannel) {
  const io::Image image =
      falseColor(imageOf(4, {0.0f, 2.0f, 1.0f, kNan}), {.scale = {2.0f, false}, .legend = false, .bits = 8});
  ASSERT_EQ(image.height, 1u);
  ASSERT_EQ(image.channels, 3u);
  const auto expectColor = [&](std::uint32_t x, vec3 color) {
    for (glm::length_t c = 0; c < 3; ++c)
      EXPECT_EQ(image.pixel<std::uint8_t>(x, 0)[static_cast<std::size_t>(c)], std::lround(255.0f * color[c])) << x;
  };
  expectColor(0, viridis(0.0f));
  expectColor(1, viridis(1.0f));
  expectColor(2, viridis(0.5f));
  expectColor(3, vec3(1.0f, 0.0f, 1.0f));
}

TEST(FalseColor, AllZeroIsDark) {
  const io::Image image = falseColor(imageOf(1, {0.0f}), {.scale = {0.0f, false}, .legend = false, .bits = 16});
  EXPECT_EQ(image.pixel<std::uint16_t>(0, 0)[0], std::lround(65535.0f * viridis(0.0f).x));
}

// The rows of the legend as text: '#' for text, '.' for the background, '~' for the color bar.
std::vector<std::string> legendOf(std::uint32_t width, float maximum, bool exceeded = false) {
  const io::Image image = falseColor(imageOf(width, std::vector<float>(width, 0.0f)), {.scale = {maximum, exceeded}});
  EXPECT_EQ(image.height, 1 + kLegendRows);
  std::vector<std::string> rows;
  for (std::uint32_t y = 1; y < image.height; ++y) {
    std::string& row = rows.emplace_back();
    for (std::uint32_t x = 0; x < width; ++x) {
      const auto p = image.pixel<std::uint8_t>(x, y);
      const bool gray = p[0] == p[1] && p[1] == p[2];
      row += !gray ? '~' : p[0] > 128 ? '#' : '.';
    }
  }
  return rows;
}

TEST(FalseColor, LegendHasTheColorsAndTheValues) {
  const std::vector<std::string> rows = legendOf(80, 14.0f);
  EXPECT_EQ(rows[3], std::string(80, '.'));
  EXPECT_EQ(rows[4], "...." + std::string(72, '~') + "....");
  // The top rows of "0", "7" in the middle, and "14" at the end.
  EXPECT_EQ(rows[13], ".....###.............................#####.........................#......#.....");
  EXPECT_EQ(legendOf(80, 14.0f, true)[13],
            ".....###.............................#####..................#......#......#.....");
}

TEST(FalseColor, LegendSkipsCharactersWithoutGlyph) {
  // "inf" has none.
  EXPECT_EQ(legendOf(80, std::numeric_limits<float>::infinity())[13], ".....###" + std::string(72, '.'));
}

TEST(FalseColor, LegendOfANarrowImageHasFewerLabels) {
  const auto hasText = [](const std::vector<std::string>& rows) {
    return std::ranges::any_of(rows, [](const std::string& row) { return row.find('#') != row.npos; });
  };
  EXPECT_TRUE(hasText(legendOf(25, 123.0f)));
  for (std::uint32_t width = 1; width < 25; ++width) EXPECT_FALSE(hasText(legendOf(width, 123.0f))) << width;
}

}  // namespace
}  // namespace quintet::render
