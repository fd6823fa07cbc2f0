// SPDX-License-Identifier: Apache-2.0
// The environment table: the probability of each cell computed by hand.
#include "render/lights/environment_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace quintet::render {
namespace {

constexpr double kFullSphere = 4.0 * std::numbers::pi;

scene::Environment mapOf(std::uint32_t width, std::uint32_t height, const vec3& color) {
  scene::Environment environment;
  environment.present = true;
  environment.image = io::makeImage(width, height, 3, io::PixelType::f32, io::ColorEncoding::linear);
  const std::span<float> samples = environment.image.samples<float>();
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = color[i % 3];
  return environment;
}

void setTexel(scene::Environment& environment, std::uint32_t x, std::uint32_t y, float value) {
  for (float& c : environment.image.pixel<float>(x, y)) c = value;
}

double cellAngle(const EnvironmentTable& table, std::size_t row) {
  const double step = std::numbers::pi / table.height;
  return 2.0 * std::numbers::pi / table.width *
         (std::cos(static_cast<double>(row) * step) - std::cos(static_cast<double>(row + 1) * step));
}

TEST(EnvironmentTable, HasOneCellForAConstant) {
  scene::Environment environment;
  environment.constant = vec3(0.5f);
  environment.intensity = 2.0f;
  const EnvironmentTable table = buildEnvironmentTable(environment);
  ASSERT_EQ(table.entries.size(), 1u);
  EXPECT_EQ(table.width, 1u);
  EXPECT_EQ(table.height, 1u);
  EXPECT_EQ(table.entries[0].probability, 1.0f);
  EXPECT_NEAR(table.integral, kFullSphere, 1e-5);
}

TEST(EnvironmentTable, IsUniformForAConstantMap) {
  for (const uvec2 size : {uvec2(1, 1), uvec2(2, 1), uvec2(8, 4), uvec2(31, 17), uvec2(512, 256)}) {
    const EnvironmentTable table = buildEnvironmentTable(mapOf(size.x, size.y, vec3(3.0f)));
    ASSERT_EQ(uvec2(table.width, table.height), size);
    EXPECT_NEAR(table.integral, 3.0 * kFullSphere, 1e-4);
    for (std::size_t i = 0; i < table.entries.size(); ++i)
      ASSERT_NEAR(table.entries[i].probability / cellAngle(table, i / size.x), 1.0 / kFullSphere, 1e-6);
  }
}

TEST(EnvironmentTable, BalancedCellsHaveWhatIsAboveTheMean) {
  scene::Environment environment = mapOf(16, 8, vec3(1.0f));
  setTexel(environment, 5, 2, 40.0f);
  setTexel(environment, 11, 6, 3.0f);
  environment.intensity = 2.0f;
  const EnvironmentTable table = buildEnvironmentTable(environment);
  ASSERT_EQ(table.balanced.size(), table.entries.size());
  const double mean = table.unscaledIntegral / kFullSphere;
  std::vector<double> above;
  double sum = 0.0;
  for (std::size_t i = 0; i < table.entries.size(); ++i) {
    const double weight = table.entries[i].probability * table.unscaledIntegral;
    above.push_back(std::max(weight - mean * cellAngle(table, i / table.width), 0.0));
    sum += above.back();
  }
  std::size_t zeros = 0;
  for (std::size_t i = 0; i < above.size(); ++i) {
    EXPECT_NEAR(table.balanced[i].probability, above[i] / sum, 1e-6) << i;
    zeros += table.balanced[i].probability == 0.0f ? 1 : 0;
  }
  EXPECT_GT(zeros, above.size() / 2);
  EXPECT_LT(zeros, above.size());
}

// All cells would have rounding errors for weights.
TEST(EnvironmentTable, HasNoBalancedCellsForANearlyConstantMap) {
  EXPECT_TRUE(buildEnvironmentTable(mapOf(31, 17, vec3(3.0f))).balanced.empty());
  scene::Environment environment = mapOf(31, 17, vec3(3.0f));
  setTexel(environment, 5, 9, 3.1f);
  EXPECT_TRUE(buildEnvironmentTable(environment).balanced.empty());
  EXPECT_TRUE(buildEnvironmentTable({}).balanced.empty());
}

TEST(EnvironmentTable, IsEmptyForBlack) {
  EXPECT_EQ(buildEnvironmentTable({}).width, 0u);
  EXPECT_TRUE(buildEnvironmentTable(mapOf(8, 4, vec3(0.0f))).entries.empty());
  scene::Environment off = mapOf(8, 4, vec3(1.0f));
  off.intensity = 0.0f;
  EXPECT_EQ(buildEnvironmentTable(off).width, 0u);
}

// Bilinear filtering extends a texel by up to one texel: its eight neighbors are sampled as well, with the mean weights
// 1/8, 3/4, 1/8 along each axis, across the seam in u but not across the poles.
TEST(EnvironmentTable, SpreadsATexelToItsNeighbors) {
  const std::array<double, 3> weight{0.125, 0.75, 0.125};
  for (const uvec2 bright : {uvec2(5, 4), uvec2(0, 3), uvec2(15, 0), uvec2(7, 7)}) {
    scene::Environment environment = mapOf(16, 8, vec3(0.0f));
    setTexel(environment, bright.x, bright.y, 100.0f);
    const EnvironmentTable table = buildEnvironmentTable(environment);
    std::vector<double> expected(16 * 8, 0.0);
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const int y = std::clamp(static_cast<int>(bright.y) + dy, 0, 7);
        const int x = (static_cast<int>(bright.x) + dx + 16) % 16;
        // Beyond a pole, clamping repeats the same row.
        expected[y * 16 + x] += weight[dx + 1] * weight[dy + 1] * cellAngle(table, y);
      }
    double sum = 0.0;
    for (const double w : expected) sum += w;
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(table.entries[i].probability, expected[i] / sum, 1e-6) << i << " of " << bright.x << "," << bright.y;
    EXPECT_NEAR(table.integral, 100.0 * sum, 1e-4);
  }
}

TEST(EnvironmentTable, CoarsensLargeMaps) {
  scene::Environment environment = mapOf(5000, 3, vec3(0.0f));
  setTexel(environment, 2500, 1, 7.0f);
  const EnvironmentTable table = buildEnvironmentTable(environment);
  ASSERT_EQ(table.width, kMaxEnvironmentTableWidth);
  ASSERT_EQ(table.height, 3u);
  // Texels 2499 … 2501 are lit: u in [2499, 2502] / 5000.
  const double scale = 4096.0 / 5000.0;
  for (std::size_t x = 0; x < table.width; ++x) {
    const bool lit = static_cast<double>(x)<2502.0 * scale&& static_cast<double>(x + 1)> 2499.0 * scale;
    ASSERT_EQ(table.entries[4096 + x].probability > 0.0f, lit) << x;
  }
  // The texel is 1/5000 of its row. Filtering moves a quarter of its light to the adjacent rows.
  const double rows = 4096.0 * (0.125 * cellAngle(table, 0) + 0.75 * cellAngle(table, 1) + 0.125 * cellAngle(table, 2));
  EXPECT_NEAR(table.integral, 7.0 / 5000.0 * rows, 1e-6);
  const EnvironmentTable constant = buildEnvironmentTable(mapOf(4099, 5, vec3(1.0f)));
  for (std::size_t i = 0; i < constant.entries.size(); ++i)
    ASSERT_NEAR(constant.entries[i].probability / cellAngle(constant, i / 4096), 1.0 / kFullSphere, 1e-6);
}

TEST(EnvironmentTable, ToleratesInvalidTexels) {
  scene::Environment environment = mapOf(8, 4, vec3(1.0f));
  setTexel(environment, 1, 1, std::nanf(""));
  setTexel(environment, 5, 2, -100.0f);
  setTexel(environment, 6, 2, std::numeric_limits<float>::infinity());
  const EnvironmentTable table = buildEnvironmentTable(environment);
  EXPECT_TRUE(std::isfinite(table.integral));
  for (const shared::AliasEntry& entry : table.entries) EXPECT_GT(entry.probability, 0.0f);
  EXPECT_GT(table.entries[2 * 8 + 6].probability, 0.3f);  // the infinite one
}

TEST(EnvironmentTable, ReadsOtherPixelTypesAndChannels) {
  scene::Environment environment;
  environment.image = io::makeImage(4, 2, 1, io::PixelType::u8, io::ColorEncoding::linear);
  for (std::uint8_t& v : environment.image.samples<std::uint8_t>()) v = 51;
  EXPECT_NEAR(buildEnvironmentTable(environment).integral, 0.2 * kFullSphere, 1e-5);
  environment.image = io::makeImage(4, 2, 4, io::PixelType::f32, io::ColorEncoding::linear);
  for (float& v : environment.image.samples<float>()) v = 0.25f;
  EXPECT_NEAR(buildEnvironmentTable(environment).integral, 0.25 * kFullSphere, 1e-5);
}

}  // namespace
}  // namespace quintet::render
