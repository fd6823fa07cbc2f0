// SPDX-License-Identifier: Apache-2.0
// Spatial orders for drivers that halve the index range.
#include "rt/spatial_order.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace quintet::rt {
namespace {

std::vector<Bounds3> cloud(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::vector<Bounds3> boxes(count);
  for (Bounds3& box : boxes) {
    box.min = vec3(unit(random), unit(random), unit(random));
    box.max = box.min + 0.01f * unit(random);
  }
  return boxes;
}

std::vector<std::uint32_t> identity(std::size_t count) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  return order;
}

bool isPermutation(std::vector<std::uint32_t> order) {
  std::ranges::sort(order);
  return order == identity(order.size());
}

TEST(SpatialOrder, IsAPermutation) {
  for (const std::size_t count : {0u, 1u, 2u, 3u, 4u, 5u, 7u, 8u, 9u, 255u, 256u, 257u, 16384u, 16385u, 50000u}) {
    const auto order = spatialOrder(cloud(count, 1));
    EXPECT_EQ(order.size(), count);
    EXPECT_TRUE(isPermutation(order)) << count;
  }
}

TEST(SpatialOrder, ReducesTheTreeCost) {
  const auto boxes = cloud(20000, 2);
  const double random = halvingTreeCost(boxes, identity(boxes.size()));
  const double ordered = halvingTreeCost(boxes, spatialOrder(boxes));
  EXPECT_LT(ordered, random / 50.0);
  EXPECT_LT(ordered, 110.0);  // measured: 98
}

TEST(SpatialOrder, GivesTheLeftHalfTheExtraBox) {
  // Two clusters: 3 boxes on the left, 2 on the right. No other division is compact.
  std::vector<Bounds3> boxes;
  for (const float x : {10.0f, 0.0f, 10.1f, 0.1f, 0.2f}) boxes.push_back({vec3(x, 0, 0), vec3(x + 0.05f, 1, 1)});
  auto order = spatialOrder(boxes);
  std::sort(order.begin(), order.begin() + 3);
  EXPECT_EQ((std::vector<std::uint32_t>(order.begin(), order.begin() + 3)), (std::vector<std::uint32_t>{1, 3, 4}));
}

// The axis without extent must never be selected.
TEST(SpatialOrder, SortsFlatGrids) {
  std::vector<Bounds3> boxes;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) boxes.push_back({vec3(x, 0, y), vec3(x + 1, 0, y + 1)});
  std::shuffle(boxes.begin(), boxes.end(), std::mt19937(3));
  const double cost = halvingTreeCost(boxes, spatialOrder(boxes));
  EXPECT_NEAR(cost, 13.0, 0.1);  // for a power of two, each of the 13 levels covers the grid once
}

TEST(SpatialOrder, AcceptsEqualAndExtremeBoxes) {
  std::vector<Bounds3> boxes(5000, Bounds3{vec3(1), vec3(2)});
  EXPECT_TRUE(isPermutation(spatialOrder(boxes)));
  const float large = std::numeric_limits<float>::max();
  std::mt19937 random(4);
  for (Bounds3& box : boxes) box = {vec3(random() % 2 ? -large : 0.0f), vec3(random() % 2 ? large : 0.0f)};
  EXPECT_TRUE(isPermutation(spatialOrder(boxes)));
  for (Bounds3& box : boxes)
    if (random() % 2) box = random() % 2 ? Bounds3{} : Bounds3{vec3(std::nanf("")), vec3(1)};
  EXPECT_TRUE(isPermutation(spatialOrder(boxes)));
}

TEST(SpatialOrder, IsIndependentOfTheNumberOfThreads) {
  const auto boxes = cloud(200'000, 5);
  const auto parallel = spatialOrder(boxes);
  cpu_set_t all, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
  CPU_ZERO(&one);
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(cpu, &all)) {
      CPU_SET(cpu, &one);
      break;
    }
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  const auto serial = spatialOrder(boxes);
  sched_setaffinity(0, sizeof all, &all);
  EXPECT_EQ(parallel, serial);
}

TEST(SpatialOrder, KeepsTheIndexRangesOfGroups) {
  const auto boxes = cloud(10'007, 6);
  const std::vector<std::size_t> sizes{1, 0, 4000, 5, 3000, 3000, 1, 0};
  const auto order = spatialOrder(boxes, sizes);
  EXPECT_TRUE(isPermutation(order));
  std::size_t first = 0;
  for (const std::size_t size : sizes) {
    for (std::size_t k = first; k < first + size; ++k) {
      EXPECT_GE(order[k], first);
      EXPECT_LT(order[k], first + size);
    }
    first += size;
  }
  EXPECT_LT(halvingTreeCost(boxes, order), halvingTreeCost(boxes, identity(boxes.size())) / 10.0);
}

}  // namespace
}  // namespace quintet::rt
