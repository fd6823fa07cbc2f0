// SPDX-License-Identifier: Apache-2.0
#include "base/suggestion.h"

#include <gtest/gtest.h>

namespace quintet {
namespace {

const std::vector<std::string> kNames{"bounces", "roulette_start", "clamp"};

TEST(Suggestion, FindsTheNearestName) {
  EXPECT_EQ(nearestName("bounce", kNames), "bounces");
  EXPECT_EQ(nearestName("rouletestart", kNames), "roulette_start");
  EXPECT_EQ(nearestName("clamp", kNames), "clamp");
  EXPECT_EQ(nearestName("CLAMP", kNames), "");
  EXPECT_EQ(nearestName("exposure_compensation", kNames), "");
  EXPECT_EQ(nearestName("x", {}), "");
}

TEST(Suggestion, PrefersTheFirstOfEquallyNearNames) {
  EXPECT_EQ(nearestName("ab", {"ac", "ad"}), "ac");
  EXPECT_EQ(nearestName("ad", {"ac", "ad"}), "ad");
}

TEST(Suggestion, IgnoresVeryLongNames) {
  const std::string name(64, 'a');
  EXPECT_EQ(nearestName(name, {name}), name);
  EXPECT_EQ(nearestName(name + "a", {name}), "");
}

TEST(Suggestion, FormatsHints) {
  EXPECT_EQ(suggestion("clmp", kNames), " (did you mean 'clamp'?)");
  EXPECT_EQ(suggestion("environment", kNames), "");
  EXPECT_EQ(suggestionOrList("clmp", kNames), " (did you mean 'clamp'?)");
  EXPECT_EQ(suggestionOrList("environment", kNames), "; available: bounces, roulette_start, clamp");
}

}  // namespace
}  // namespace quintet
