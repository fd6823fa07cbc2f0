// SPDX-License-Identifier: Apache-2.0
// The tone curves at points computed by hand from their definitions, and properties that hold for all values.
#include "render/tone_map/tone_map.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace quintet::render {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr ToneMap kAll[] = {ToneMap::linear, ToneMap::aces, ToneMap::agx, ToneMap::neutral};

void expectColor(ToneMap operation, const vec3& color, const vec3& expected) {
  const vec3 result = toneMap(operation, color);
  for (glm::length_t i = 0; i < 3; ++i)
    EXPECT_NEAR(result[i], expected[i], 2e-5f) << toneMapNames()[static_cast<std::size_t>(operation)] << " of "
                                               << color.r << ' ' << color.g << ' ' << color.b << ", channel " << i;
}

// One row of linear premultiplied RGBA.
io::Image row(const std::vector<vec4>& pixels) {
  auto image =
      io::makeImage(static_cast<std::uint32_t>(pixels.size()), 1, 4, io::PixelType::f32, io::ColorEncoding::linear);
  for (std::uint32_t x = 0; x < image.width; ++x)
    for (glm::length_t i = 0; i < 4; ++i) image.pixel<float>(x, 0)[i] = pixels[x][i];
  image.premultiplied = true;
  return image;
}

std::vector<int> bytes(const io::Image& image) {
  const auto samples = image.samples<std::uint8_t>();
  return {samples.begin(), samples.end()};
}

TEST(ToneMap, FindsOperationsByName) {
  const auto names = toneMapNames();
  ASSERT_EQ(names.size(), std::size(kAll));
  for (const ToneMap operation : kAll) EXPECT_EQ(toneMapByName(names[static_cast<std::size_t>(operation)]), operation);
  EXPECT_FALSE(toneMapByName("filmic"));
  EXPECT_FALSE(toneMapByName(""));
}

TEST(ToneMap, ClampsLinear) {
  expectColor(ToneMap::linear, {0.18f, 1.0f, 10.0f}, {0.18f, 1.0f, 1.0f});
  expectColor(ToneMap::linear, {-1.0f, 0.0f, 0.5f}, {0.0f, 0.0f, 0.5f});
}

TEST(ToneMap, MatchesHillsFitOfAces) {
  expectColor(ToneMap::aces, vec3(0.18f), {0.21311f, 0.21311f, 0.21310f});
  expectColor(ToneMap::aces, vec3(1.0f), {0.76340f, 0.76340f, 0.76339f});
  expectColor(ToneMap::aces, vec3(10.0f), {0.99101f, 0.99101f, 0.99100f});
  expectColor(ToneMap::aces, {1, 0, 0}, {0.95733f, 0.00532f, 0.00716f});
  expectColor(ToneMap::aces, {0, 0, 10}, {0.70734f, 0.13572f, 1.0f});
  expectColor(ToneMap::aces, {0.5f, 0.3f, 0.04f}, {0.56564f, 0.37919f, 0.05347f});
}

TEST(ToneMap, MatchesThePolynomialOfAgx) {
  expectColor(ToneMap::agx, vec3(0.18f), {0.21447f, 0.21453f, 0.21454f});
  expectColor(ToneMap::agx, vec3(1.0f), {0.58998f, 0.59021f, 0.59022f});
  expectColor(ToneMap::agx, vec3(10.0f), {0.95492f, 0.95536f, 0.95538f});
  expectColor(ToneMap::agx, {1, 0, 0}, {0.71942f, 0.03949f, 0.03955f});
  expectColor(ToneMap::agx, {0, 0, 10}, {0.50067f, 0.50072f, 1.0f});
  expectColor(ToneMap::agx, {0.5f, 0.3f, 0.04f}, {0.45161f, 0.32455f, 0.07985f});
}

TEST(ToneMap, MatchesKhronosNeutral) {
  // Below the start of the compression, only the Fresnel offset of 0.04 is subtracted.
  expectColor(ToneMap::neutral, vec3(0.18f), vec3(0.14f));
  expectColor(ToneMap::neutral, {0.5f, 0.3f, 0.04f}, {0.47f, 0.27f, 0.01f});
  // White has the peak 0.96 and the new peak 1 - 0.24² / (0.96 - 0.52).
  expectColor(ToneMap::neutral, vec3(1.0f), vec3(1.0f - 0.0576f / 0.44f));
  expectColor(ToneMap::neutral, vec3(10.0f), vec3(0.99390f));
  expectColor(ToneMap::neutral, {1, 0, 0}, {0.88f, 0.01556f, 0.01556f});
  expectColor(ToneMap::neutral, {0, 0, 10}, {0.57114f, 0.57114f, 0.99392f});
}

TEST(ToneMap, MapsBlackAndNanToBlack) {
  for (const ToneMap operation : kAll) {
    expectColor(operation, vec3(0.0f), vec3(0.0f));
    expectColor(operation, vec3(kNaN), vec3(0.0f));
    expectColor(operation, vec3(-kInfinity), vec3(0.0f));
    const vec3 mixed = toneMap(operation, {kNaN, 0.5f, kInfinity});
    EXPECT_TRUE(isFinite(mixed));
  }
}

TEST(ToneMap, MapsInfinityToNearlyWhite) {
  for (const ToneMap operation : kAll) {
    const vec3 result = toneMap(operation, vec3(kInfinity));
    for (glm::length_t i = 0; i < 3; ++i) EXPECT_GT(result[i], 0.98f);
  }
}

TEST(ToneMap, IsMonotonicForGrays) {
  for (const ToneMap operation : kAll) {
    float last = 0.0f;
    for (int step = -200; step <= 200; ++step) {
      const vec3 result = toneMap(operation, vec3(std::exp2(static_cast<float>(step) * 0.1f)));
      EXPECT_GE(result.g, last - 1e-6f) << toneMapNames()[static_cast<std::size_t>(operation)] << ", step " << step;
      EXPECT_LE(result.g, 1.0f);
      last = result.g;
    }
  }
}

TEST(ToDisplay, EncodesOpaqueAsSrgbBytes) {
  const auto result =
      toDisplay(row({{0, 0, 0, 1}, {0.18f, 0.5f, 1, 1}, {2, kNaN, -1, 1}}), ToneMap::linear, 0.0f, true);
  EXPECT_EQ(result.channels, 3u);
  EXPECT_EQ(result.encoding, io::ColorEncoding::sRgb);
  EXPECT_EQ(bytes(result), (std::vector<int>{0, 0, 0, 118, 188, 255, 255, 0, 0}));
}

TEST(ToDisplay, EncodesWith16Bits) {
  const auto result = toDisplay(row({{0, 0.18f, 1, 1}, {0.0001f, 0.5f, kNaN, 0.5f}}), ToneMap::linear, 0.0f, false, 16);
  ASSERT_EQ(result.type, io::PixelType::u16);
  const auto values = result.samples<std::uint16_t>();
  // 65535 · sRGB(x) by IEC 61966-2-1.
  const std::vector<int> expected{0, 30235, 65535, 65535, 169, 65535, 0, 32768};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(values[i], expected[i], 1) << i;
}

TEST(ToDisplay, DividesByAlphaBeforeTheCurve) {
  const auto result =
      toDisplay(row({{0.09f, 0.25f, 0.5f, 0.5f}, {0, 0, 0, 0}, {1, 1, 1, 0}}), ToneMap::linear, 0.0f, false);
  EXPECT_EQ(result.channels, 4u);
  EXPECT_FALSE(result.premultiplied);
  EXPECT_EQ(bytes(result), (std::vector<int>{118, 188, 255, 128, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(ToDisplay, ToleratesInvalidAlpha) {
  const auto result = toDisplay(row({{1, 1, 1, kNaN}, {1, 1, 1, -1}, {3, 3, 3, 3}}), ToneMap::linear, 0.0f, false);
  EXPECT_EQ(bytes(result), (std::vector<int>{0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 255}));
}

TEST(ToDisplay, AppliesExposureInStops) {
  const auto brighter = toDisplay(row({{0.09f, 0.125f, 0.25f, 1}}), ToneMap::linear, 1.0f, true);
  const auto darker = toDisplay(row({{0.72f, 1, 2, 1}}), ToneMap::linear, -2.0f, true);
  EXPECT_EQ(bytes(brighter), (std::vector<int>{118, 137, 188}));
  EXPECT_EQ(bytes(darker), (std::vector<int>{118, 137, 188}));
}

TEST(ToDisplay, ConvertsEveryRow) {
  auto image = io::makeImage(7, 301, 4, io::PixelType::f32, io::ColorEncoding::linear);
  for (auto& sample : image.samples<float>()) sample = 1.0f;
  const io::Image display = toDisplay(image, ToneMap::linear, 0.0f, false);
  for (const std::uint8_t byte : display.samples<std::uint8_t>()) ASSERT_EQ(byte, 255);
}

}  // namespace
}  // namespace quintet::render
