// SPDX-License-Identifier: Apache-2.0
// What a ray costs in trees of both kinds of builders.
#include "rt/build_cost.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace quintet::rt {
namespace {

using Boxes = std::vector<Bounds3>;

Boxes unitCubes(std::initializer_list<float> positions) {
  Boxes boxes;
  for (const float x : positions) boxes.push_back({vec3(x, 0, 0), vec3(x + 1, 1, 1)});
  return boxes;
}

Boxes mixed(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  Boxes boxes(count);
  for (Bounds3& box : boxes) {
    box.min = vec3(unit(random), unit(random), unit(random));
    box.max = box.min + 0.2f * vec3(unit(random), unit(random), unit(random));
  }
  return boxes;
}

// The least cost of any binary tree, by trying all divisions of each subset of the boxes.
double leastCost(const Boxes& boxes) {
  const std::size_t subsets = std::size_t{1} << boxes.size();
  std::vector<double> sums(subsets, 0.0);
  const auto areaOf = [&](std::size_t subset) {
    Bounds3 whole;
    for (std::size_t k = 0; k < boxes.size(); ++k)
      if (subset >> k & 1u) whole.extend(boxes[k]);
    return static_cast<double>(whole.area());
  };
  for (std::size_t subset = 1; subset < subsets; ++subset) {
    double children = (subset & (subset - 1)) == 0 ? 0.0 : std::numeric_limits<double>::infinity();
    for (std::size_t part = (subset - 1) & subset; part > 0; part = (part - 1) & subset)
      children = std::min(children, sums[part] + sums[subset ^ part]);
    sums[subset] = areaOf(subset) + children;
  }
  return sums.back() / areaOf(subsets - 1);
}

TEST(BuildCost, AddsTheAreasOfAHalvingTree) {
  // Areas for unit cubes at x = 0, 1, 2 and the tree ((0 1) 2): three leaves of 6, the pair 10, the root 14.
  const Boxes boxes = unitCubes({0, 1, 2});
  EXPECT_NEAR(halvingTreeCost(boxes, std::vector<std::uint32_t>{0, 1, 2}), (18.0 + 10.0 + 14.0) / 14.0, 1e-6);
  EXPECT_NEAR(halvingTreeCost(boxes, std::vector<std::uint32_t>{0, 2, 1}), (18.0 + 14.0 + 14.0) / 14.0, 1e-6);
  EXPECT_EQ(halvingTreeCost({}, {}), 0.0);
}

TEST(BuildCost, IsThatOfTheBuilder) {
  // Cubes at 0, 1, 2 and 9: a halving tree pairs the last two, the other one separates the last.
  const Boxes boxes = unitCubes({0, 1, 2, 9});
  EXPECT_NEAR(treeCost(boxes, TreeBuilder::halving), (24.0 + 10.0 + 34.0 + 42.0) / 42.0, 1e-6);
  EXPECT_NEAR(treeCost(boxes, TreeBuilder::surfaceArea), (24.0 + 10.0 + 14.0 + 42.0) / 42.0, 1e-6);
}

TEST(BuildCost, IsCloseToTheLeast) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const Boxes boxes = mixed(9, seed);
    const double least = leastCost(boxes);
    const double cost = treeCost(boxes, TreeBuilder::surfaceArea);
    EXPECT_GE(cost, least * (1 - 1e-6)) << seed;
    EXPECT_LE(cost, least * 1.25) << seed;
  }
}

TEST(BuildCost, AcceptsEqualAndFlatBoxes) {
  EXPECT_EQ(treeCost({}, TreeBuilder::surfaceArea), 0.0);
  EXPECT_EQ(treeCost(Boxes(3, {vec3(1), vec3(1)}), TreeBuilder::surfaceArea), 0.0);  // points have no area
  EXPECT_NEAR(treeCost(Boxes(64, {vec3(0), vec3(1)}), TreeBuilder::surfaceArea), 127.0, 1e-6);
  EXPECT_NEAR(treeCost(Boxes(4, {vec3(0), vec3(1, 1, 0)}), TreeBuilder::surfaceArea), 7.0, 1e-6);
}

}  // namespace
}  // namespace quintet::rt
