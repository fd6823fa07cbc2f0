// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/resolution_control.h"

#include <gtest/gtest.h>

namespace quintet::job::interactive {
namespace {

TEST(ResolutionControl, HoldsTheRate) {
  ResolutionControl control(10);  // 0.1 s per image
  control.measured(1, 0.05);
  EXPECT_EQ(control.factor(), 1u);
  control.measured(1, 0.25);
  EXPECT_EQ(control.factor(), 2u);
  control.measured(2, 0.3);  // 1.2 s at full resolution
  EXPECT_EQ(control.factor(), 4u);
  control.measured(4, 0.03);  // 0.48 s
  EXPECT_EQ(control.factor(), 3u);
  control.measured(4, 100);
  EXPECT_EQ(control.factor(), 16u) << "the coarsest";
  control.measured(8, 0.0001);
  EXPECT_EQ(control.factor(), 1u);
}

TEST(ResolutionControl, DoesNotAlternate) {
  ResolutionControl control(10);
  control.measured(1, 0.12);
  EXPECT_EQ(control.factor(), 2u);
  control.measured(2, 0.0225);  // 0.09 s at full resolution, which is close to the limit
  EXPECT_EQ(control.factor(), 2u);
  control.measured(2, 0.015);
  EXPECT_EQ(control.factor(), 1u);
}

TEST(ResolutionControl, ImagesBecomeSharperInSteps) {
  for (unsigned factor : {2u, 3u, 4u, 6u, 8u, 12u, 16u}) {
    int steps = 0;
    for (; factor > 1; ++steps) factor = finerFactor(factor);
    EXPECT_EQ(factor, 1u);
    EXPECT_LE(steps, 4);
  }
}

TEST(ResolutionControl, ReducedSizesHaveNoEmptySide) {
  EXPECT_EQ(reducedSize({800, 500}, 1), uvec2(800, 500));
  EXPECT_EQ(reducedSize({801, 500}, 4), uvec2(201, 125));
  EXPECT_EQ(reducedSize({3, 1}, 8), uvec2(1, 1));
}

}  // namespace
}  // namespace quintet::job::interactive
