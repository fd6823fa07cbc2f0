// SPDX-License-Identifier: Apache-2.0
// Which meshes share one tree on drivers that halve the index range.
#include "rt/merge_clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace quintet::rt {
namespace {

using Boxes = std::vector<Bounds3>;
using Clusters = std::vector<std::vector<std::uint32_t>>;

// Small boxes of edge `size` in the unit cube at `corner`.
Boxes scattered(std::size_t count, std::uint32_t seed, const vec3& corner = vec3(0), float size = 0.01f) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  Boxes boxes(count);
  for (Bounds3& box : boxes) {
    box.min = corner + vec3(unit(random), unit(random), unit(random));
    box.max = box.min + size;
  }
  return boxes;
}

TEST(MergeClusters, JoinsMeshesThatFillTheSameSpace) {
  const std::vector<Boxes> meshes{scattered(500, 1), scattered(2000, 2), scattered(1000, 3)};
  EXPECT_EQ(mergeClusters(meshes), (Clusters{{0, 1, 2}}));
}

TEST(MergeClusters, KeepsMeshesApartThatDoNotOverlap) {
  const std::vector<Boxes> meshes{scattered(500, 1), scattered(500, 2, {2, 0, 0}), scattered(500, 3, {0, 3, 0})};
  EXPECT_EQ(mergeClusters(meshes), Clusters{});
}

TEST(MergeClusters, FormsAClusterPerPartOfTheSpace) {
  const std::vector<Boxes> meshes{scattered(400, 1), scattered(400, 2, {5, 0, 0}), scattered(400, 3),
                                  scattered(400, 4, {5, 0, 0})};
  Clusters clusters = mergeClusters(meshes);
  std::ranges::sort(clusters);
  EXPECT_EQ(clusters, (Clusters{{0, 2}, {1, 3}}));
}

// Twelve triangles of a room would lie as deep in the tree as the small ones.
TEST(MergeClusters, KeepsAFewLargeTrianglesApart) {
  Boxes room;
  for (const float side : {0.0f, 1.0f}) {
    for (int k = 0; k < 2; ++k) {
      room.push_back({vec3(side, 0, 0), vec3(side, 1, 1)});
      room.push_back({vec3(0, side, 0), vec3(1, side, 1)});
      room.push_back({vec3(0, 0, side), vec3(1, 1, side)});
    }
  }
  EXPECT_EQ(mergeClusters(std::vector<Boxes>{room, scattered(4000, 1)}), Clusters{});
}

TEST(MergeClusters, SkipsEmptyMeshesAndAcceptsNone) {
  EXPECT_EQ(mergeClusters({}), Clusters{});
  EXPECT_EQ(mergeClusters(std::vector<Boxes>{{}, scattered(100, 1)}), Clusters{});
  EXPECT_EQ(mergeClusters(std::vector<Boxes>{{}, scattered(100, 1), {}, scattered(100, 2)}), (Clusters{{1, 3}}));
}

}  // namespace
}  // namespace quintet::rt
