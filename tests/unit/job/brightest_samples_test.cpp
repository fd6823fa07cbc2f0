// SPDX-License-Identifier: Apache-2.0
// Which samples count as fireflies.
#include "job/brightest_samples.h"

#include <gtest/gtest.h>

#include <limits>

namespace quintet::job {
namespace {

constexpr uvec2 kSize{16, 12};

// Samples of luminance 1, except `value` in one pixel and sample.
std::vector<Firefly> fireflies(float value, uvec2 pixel, std::uint32_t sample, std::uint32_t count, float base = 1.0f,
                               float threshold = 2.0f) {
  BrightestSamples brightest(kSize);
  for (std::uint32_t s = 0; s < count; ++s) {
    std::vector<vec4> values(std::size_t{kSize.x} * kSize.y, vec4(base));
    if (s == sample) values[pixel.y * kSize.x + pixel.x] = vec4(value);
    brightest.add(s, values);
  }
  return brightest.find(threshold);
}

TEST(BrightestSamples, FindsASampleThatOutshinesItsSurroundings) {
  const std::vector<Firefly> found = fireflies(100.0f, {5, 7}, 3, 8);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].pixel, uvec2(5, 7));
  EXPECT_EQ(found[0].sample, 3u);
  EXPECT_FLOAT_EQ(found[0].luminance, 100.0f);
  EXPECT_FLOAT_EQ(found[0].level, 1.0f);
  EXPECT_FLOAT_EQ(found[0].ratio, 12.5f);
}

// The threshold is the share of the sample in the pixel, relative to the level.
TEST(BrightestSamples, ComparesTheShareWithTheThreshold) {
  EXPECT_EQ(fireflies(16.5f, {0, 0}, 0, 8).size(), 1u);
  EXPECT_EQ(fireflies(15.5f, {0, 0}, 0, 8).size(), 0u);
  EXPECT_EQ(fireflies(15.5f, {0, 0}, 0, 8, 1.0f, 1.9f).size(), 1u);
  EXPECT_EQ(fireflies(1e6f, {0, 0}, 0, 3).size(), 0u) << "too few samples";
}

TEST(BrightestSamples, IgnoresBrightObjectsAndBlackSurroundings) {
  BrightestSamples bright(kSize);
  for (std::uint32_t s = 0; s < 8; ++s) {
    std::vector<vec4> values(std::size_t{kSize.x} * kSize.y, vec4(1.0f));
    values[40] = vec4(100.0f);  // in all samples
    bright.add(s, values);
  }
  EXPECT_TRUE(bright.find(2.0f).empty());
  EXPECT_TRUE(fireflies(0.0f, {0, 0}, 0, 8, 0.0f).empty()) << "a black image";
  EXPECT_EQ(fireflies(1.0f, {3, 3}, 0, 8, 0.0f).size(), 1u) << "the only light of the image";
}

// A pixel at the corner of a bright square is bright in a few of its samples.
TEST(BrightestSamples, IgnoresEdgesOfBrightObjects) {
  BrightestSamples brightest(kSize);
  for (std::uint32_t s = 0; s < 8; ++s) {
    std::vector<vec4> values(std::size_t{kSize.x} * kSize.y, vec4(0.0f));
    for (std::uint32_t y = 0; y < 5; ++y)
      for (std::uint32_t x = 0; x < 5; ++x) values[y * kSize.x + x] = vec4(1.0f);
    values[5 * kSize.x + 5] = vec4(s == 3 ? 1.0f : 0.0f);
    brightest.add(s, values);
  }
  EXPECT_TRUE(brightest.find(2.0f).empty());
}

TEST(BrightestSamples, IgnoresWhatIsNotFinite) {
  EXPECT_TRUE(fireflies(std::numeric_limits<float>::infinity(), {5, 5}, 2, 8).empty());
  EXPECT_TRUE(fireflies(std::numeric_limits<float>::quiet_NaN(), {5, 5}, 2, 8).empty());
}

TEST(BrightestSamples, SortsByRatio) {
  BrightestSamples brightest(kSize);
  for (std::uint32_t s = 0; s < 8; ++s) {
    std::vector<vec4> values(std::size_t{kSize.x} * kSize.y, vec4(1.0f));
    if (s == 1) values[3] = vec4(50.0f);
    if (s == 2) values[180] = vec4(500.0f);
    if (s == 5) values[100] = vec4(90.0f);
    brightest.add(s, values);
  }
  const std::vector<Firefly> found = brightest.find(2.0f);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].sample, 2u);
  EXPECT_EQ(found[1].sample, 5u);
  EXPECT_EQ(found[2].sample, 1u);
}

}  // namespace
}  // namespace quintet::job
