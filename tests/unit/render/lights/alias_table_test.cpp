// SPDX-License-Identifier: Apache-2.0
// The alias table: its entries imply the stored probabilities, which equal the weights.
#include "render/lights/alias_table.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace quintet::render {
namespace {

// Returns the probabilities that follow from `keep` and `alias` alone.
std::vector<double> impliedProbabilities(const std::vector<shared::AliasEntry>& table) {
  const auto n = static_cast<double>(table.size());
  std::vector<double> result(table.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    result[i] += table[i].keep / n;
    result[table[i].alias] += (1.0 - static_cast<double>(table[i].keep)) / n;
  }
  return result;
}

// `tolerance` is the largest relative error of the stored probabilities against the weights.
void expectExact(const std::vector<float>& weights, double tolerance) {
  const std::vector<shared::AliasEntry> table = buildAliasTable(weights);
  ASSERT_EQ(table.size(), weights.size());
  const std::vector<double> implied = impliedProbabilities(table);
  double total = 0.0;
  for (const float w : weights) total += w;
  double sum = 0.0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double expected = weights[i] / total;
    const double stored = table[i].probability;
    ASSERT_GE(table[i].keep, 0.0f);
    ASSERT_LE(table[i].keep, 1.0f);
    ASSERT_LT(table[i].alias, table.size());
    ASSERT_NEAR(stored, implied[i], 1e-6 * implied[i] + 1e-38) << i;
    ASSERT_NEAR(stored, expected, tolerance * expected + 1e-38) << i;
    if (weights[i] == 0.0f) {
      ASSERT_EQ(stored, 0.0) << i;
      ASSERT_EQ(implied[i], 0.0) << i;
    }
    sum += stored;
  }
  EXPECT_NEAR(sum, 1.0, 1e-6);
}

TEST(AliasTable, MatchesSmallTablesByHand) {
  expectExact({3.0f}, 1e-7);
  expectExact({1.0f, 3.0f}, 1e-7);
  expectExact({0.0f, 2.0f}, 1e-7);
  expectExact({2.0f, 0.0f, 0.0f}, 1e-7);
  expectExact({0.0f, 0.0f, 5.0f, 0.0f}, 1e-7);
  const std::vector<shared::AliasEntry> table = buildAliasTable(std::vector<float>{1.0f, 3.0f});
  EXPECT_EQ(table[0].keep, 0.5f);
  EXPECT_EQ(table[0].alias, 1u);
  EXPECT_EQ(table[0].probability, 0.25f);
  EXPECT_EQ(table[1].keep, 1.0f);
  EXPECT_EQ(table[1].probability, 0.75f);
}

TEST(AliasTable, KeepsEqualWeights) {
  for (const std::size_t n : {2u, 3u, 7u, 64u, 1000u, 65537u}) {
    const std::vector<shared::AliasEntry> table = buildAliasTable(std::vector<float>(n, 0.3f));
    for (const shared::AliasEntry& entry : table) ASSERT_NEAR(entry.keep, 1.0f, 1e-6f);
    expectExact(std::vector<float>(n, 0.3f), 1e-6);
  }
}

TEST(AliasTable, HandlesRandomWeightsOfAllSizes) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  for (const std::size_t n : {2u, 3u, 5u, 17u, 100u, 4096u, 100'000u, 1'000'000u}) {
    std::vector<float> weights(n);
    for (float& w : weights) w = uniform(random);
    expectExact(weights, 1e-5);
    for (float& w : weights) w = uniform(random) < 0.5f ? 0.0f : w;
    weights[n / 2] = 1.0f;
    expectExact(weights, 1e-5);
  }
}

// Ratios up to 1e40: heavy entries fill up many light ones, so rounding errors add up, but not in the stored
// probabilities.
TEST(AliasTable, HandlesExtremeRatios) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> exponent(-20.0f, 20.0f);
  for (const std::size_t n : {2u, 10u, 1000u, 100'000u}) {
    std::vector<float> weights(n);
    for (float& w : weights) w = std::pow(10.0f, exponent(random));
    expectExact(weights, 1e-4);
  }
  std::vector<float> sun(1'000'000, 1e-3f);
  sun[123'456] = 1e9f;
  expectExact(sun, 1e-4);
  sun[0] = sun[999'999] = 0.0f;
  expectExact(sun, 1e-4);
}

TEST(AliasTable, IsEmptyWithoutPositiveWeights) {
  EXPECT_TRUE(buildAliasTable({}).empty());
  EXPECT_TRUE(buildAliasTable(std::vector<float>{0.0f}).empty());
  EXPECT_TRUE(buildAliasTable(std::vector<float>(100, 0.0f)).empty());
}

TEST(AliasTable, NeverSamplesInvalidWeights) {
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<shared::AliasEntry> table =
      buildAliasTable(std::vector<float>{std::nanf(""), 1.0f, -4.0f, inf, 3.0f});
  const std::vector<double> implied = impliedProbabilities(table);
  EXPECT_NEAR(implied[1], 0.25, 1e-7);
  EXPECT_NEAR(implied[4], 0.75, 1e-7);
  for (const std::size_t i : {0u, 2u, 3u}) EXPECT_EQ(implied[i], 0.0);
  for (const std::size_t i : {0u, 2u, 3u}) EXPECT_EQ(table[i].probability, 0.0f);
}

}  // namespace
}  // namespace quintet::render
