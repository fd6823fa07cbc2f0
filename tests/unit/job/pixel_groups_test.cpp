// SPDX-License-Identifier: Apache-2.0
// Which pixels are one finding.
#include "job/pixel_groups.h"

#include <vector>

#include <gtest/gtest.h>

namespace quintet::job {
namespace {

TEST(PixelGroups, TouchAtASideOrACorner) {
  // Two diagonal pixels, one apart from them by one column, and a row in the last line, not in order.
  const std::vector<uvec2> pixels{{5, 4}, {0, 0}, {3, 0}, {1, 1}, {3, 4}, {4, 4}};
  const std::vector<PixelGroup> groups = groupAdjacent({6, 5}, pixels);
  ASSERT_EQ(groups.size(), 3u);
  EXPECT_EQ(groups[0].members, (std::vector<std::size_t>{0, 4, 5})) << "the first member is the first in the list";
  EXPECT_EQ(groups[0].least, uvec2(3, 4));
  EXPECT_EQ(groups[0].most, uvec2(5, 4));
  EXPECT_EQ(groups[1].members, (std::vector<std::size_t>{1, 3}));
  EXPECT_EQ(groups[1].most, uvec2(1, 1));
  EXPECT_EQ(groups[2].members, (std::vector<std::size_t>{2})) << "a column apart";
}

// The left and the right side of the image do not touch each other.
TEST(PixelGroups, EndAtTheBordersOfTheImage) {
  const std::vector<uvec2> pixels{{3, 0}, {0, 1}, {3, 2}, {0, 2}};
  EXPECT_EQ(groupAdjacent({4, 3}, pixels).size(), 3u);
  EXPECT_TRUE(groupAdjacent({4, 3}, {}).empty());
}

}  // namespace
}  // namespace quintet::job
