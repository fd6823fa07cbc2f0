// SPDX-License-Identifier: Apache-2.0
#include "viewer/labels.h"

#include <gtest/gtest.h>

namespace quintet::viewer {
namespace {

TEST(Labels, GroupDigits) {
  EXPECT_EQ(groupedDigits(0), "0");
  EXPECT_EQ(groupedDigits(999), "999");
  EXPECT_EQ(groupedDigits(1000), "1,000");
  EXPECT_EQ(groupedDigits(129456), "129,456");
  EXPECT_EQ(groupedDigits(1234567), "1,234,567");
}

TEST(Labels, StartWithACapital) {
  EXPECT_EQ(capitalized("middle button"), "Middle button");
  EXPECT_EQ(capitalized("Shift"), "Shift");
  EXPECT_EQ(capitalized("10 rays"), "10 rays");
  EXPECT_EQ(capitalized(""), "");
}

}  // namespace
}  // namespace quintet::viewer
