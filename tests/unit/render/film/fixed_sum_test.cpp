// SPDX-License-Identifier: Apache-2.0
// FixedSum on the host: exact sums in any order.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "render/film/fixed_sum.h"

namespace quintet::render {
namespace {

bool same(const shared::FixedSum& a, const shared::FixedSum& b) {
  return std::equal(std::begin(a.word), std::end(a.word), std::begin(b.word));
}

TEST(FixedSum, RepresentsFloatsOfItsRangeExactly) {
  for (const float value :
       {0.0f, 1.0f, -1.0f, 0.1f, -3.25e-7f, 1e12f, -4.6e18f, std::ldexp(1.0f, -64), std::ldexp(-0x1.FFFFFEp0f, -41)})
    EXPECT_EQ(fixedToDouble(fixedFromFloat(value)), static_cast<double>(value)) << value;
}

TEST(FixedSum, RoundsToTheNearestUnit) {
  const double unit = std::ldexp(1.0, -64);
  EXPECT_EQ(fixedToDouble(fixedFromFloat(std::ldexp(1.4f, -64))), unit);
  EXPECT_EQ(fixedToDouble(fixedFromFloat(std::ldexp(1.5f, -64))), 2 * unit);
  EXPECT_EQ(fixedToDouble(fixedFromFloat(std::ldexp(-1.4f, -65))), -unit);
  EXPECT_EQ(fixedToDouble(fixedFromFloat(std::ldexp(0.99f, -65))), 0.0);
  EXPECT_EQ(fixedToDouble(fixedFromFloat(std::numeric_limits<float>::denorm_min())), 0.0);
}

TEST(FixedSum, ClampsToItsRange) {
  EXPECT_EQ(fixedToDouble(fixedFromFloat(3e38f)), std::ldexp(1.0, 62));
  EXPECT_EQ(fixedToDouble(fixedFromFloat(-3e38f)), -std::ldexp(1.0, 62));
}

TEST(FixedSum, StaysNotFiniteAfterSuchATerm) {
  const float inf = std::numeric_limits<float>::infinity();
  for (const float value : {inf, -inf, std::nanf("")}) {
    const shared::FixedSum bad = fixedFromFloat(value);
    EXPECT_TRUE(isNotFinite(bad));
    EXPECT_TRUE(std::isnan(fixedToDouble(addFixed(bad, fixedFromFloat(1.0f)))));
    EXPECT_TRUE(std::isnan(fixedToDouble(addFixed(fixedFromFloat(-5.0f), bad))));
    EXPECT_TRUE(isNotFinite(addFixed(bad, bad)));
  }
}

TEST(FixedSum, IsNotFiniteBeyondItsRange) {
  const shared::FixedSum big = fixedFromFloat(3e38f), small = fixedFromFloat(-3e38f);
  EXPECT_TRUE(isNotFinite(addFixed(big, big)));
  EXPECT_TRUE(isNotFinite(addFixed(addFixed(small, small), fixedFromFloat(-1.0f))));
  EXPECT_FALSE(isNotFinite(addFixed(big, fixedFromFloat(4e18f))));
  EXPECT_EQ(fixedToDouble(addFixed(big, small)), 0.0);
}

TEST(FixedSum, IsIndependentOfTheOrder) {
  std::mt19937 random(7);
  std::vector<float> terms;
  for (int i = 0; i < 1000; ++i)
    terms.push_back(std::ldexp(static_cast<float>(random()) / 4e9f - 0.5f, static_cast<int>(random() % 80) - 50));
  const auto sum = [&] {
    shared::FixedSum total{};
    for (const float term : terms) total = addFixed(total, fixedFromFloat(term));
    return total;
  };
  const shared::FixedSum first = sum();
  long double exact = 0;
  for (const float term : terms) exact += static_cast<long double>(term);
  EXPECT_NEAR(fixedToDouble(first), static_cast<double>(exact), 1e-9);
  for (int i = 0; i < 5; ++i) {
    std::shuffle(terms.begin(), terms.end(), random);
    EXPECT_TRUE(same(sum(), first));
  }
}

}  // namespace
}  // namespace quintet::render
