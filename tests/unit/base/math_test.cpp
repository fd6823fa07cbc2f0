// SPDX-License-Identifier: Apache-2.0
#include "base/math.h"

#include <gtest/gtest.h>

namespace quintet {
namespace {

TEST(BoundsTest, ExtendsAnEmptyBox) {
  Bounds3 bounds;
  EXPECT_TRUE(bounds.empty());
  EXPECT_EQ(bounds.area(), 0.0f);
  EXPECT_TRUE(bounds.transformed(mat4(2.0f)).empty());
  bounds.extend(Bounds3{});
  EXPECT_TRUE(bounds.empty());
  bounds.extend(vec3(1, 2, 3));
  EXPECT_FALSE(bounds.empty());
  EXPECT_EQ(bounds.min, vec3(1, 2, 3));
  EXPECT_EQ(bounds.max, vec3(1, 2, 3));
}

TEST(BoundsTest, MeasuresCenterExtentAndArea) {
  Bounds3 bounds;
  bounds.extend(vec3(-1, 0, 0));
  bounds.extend(vec3(1, 3, 4));
  EXPECT_EQ(bounds.center(), vec3(0, 1.5f, 2));
  EXPECT_EQ(bounds.extent(), vec3(2, 3, 4));
  EXPECT_FLOAT_EQ(bounds.area(), 2 * (6 + 12 + 8));
}

TEST(BoundsTest, BoundsTransformedCorners) {
  const Bounds3 cube{vec3(-1), vec3(1)};
  const mat4 turned = glm::translate(mat4(1), vec3(10, 0, 0)) * glm::rotate(mat4(1), kPi / 4, vec3(0, 0, 1));
  const Bounds3 moved = cube.transformed(turned);
  EXPECT_NEAR(moved.min.x, 10 - std::sqrt(2.0f), 1e-5f);
  EXPECT_NEAR(moved.max.y, std::sqrt(2.0f), 1e-5f);
  EXPECT_NEAR(moved.max.z, 1, 1e-5f);
}

TEST(MathTest, DetectsNonFiniteVectors) {
  EXPECT_TRUE(isFinite(vec3(1)));
  EXPECT_FALSE(isFinite(vec3(1, NAN, 0)));
  EXPECT_FALSE(isFinite(vec3(1, 0, -INFINITY)));
}

}  // namespace
}  // namespace quintet
