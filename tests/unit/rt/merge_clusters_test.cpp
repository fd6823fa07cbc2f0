// SPDX-License-Identifier: Apache-2.0
// Which meshes share one tree on drivers that traverse in software.
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

// Twelve triangles on the faces of the unit cube.
Boxes room() {
  Boxes room;
  for (const float side : {0.0f, 1.0f}) {
    for (int k = 0; k < 2; ++k) {
      room.push_back({vec3(side, 0, 0), vec3(side, 1, 1)});
      room.push_back({vec3(0, side, 0), vec3(1, side, 1)});
      room.push_back({vec3(0, 0, side), vec3(1, 1, side)});
    }
  }
  return room;
}

class MergeClusters : public testing::TestWithParam<TreeBuilder> {
 protected:
  static Clusters clusters(const std::vector<Boxes>& meshes) { return mergeClusters(meshes, GetParam()); }
};

INSTANTIATE_TEST_SUITE_P(Builders, MergeClusters, testing::Values(TreeBuilder::halving, TreeBuilder::surfaceArea),
                         [](const auto& test) {
                           return test.param == TreeBuilder::halving ? "Halving" : "SurfaceArea";
                         });

TEST_P(MergeClusters, JoinsMeshesThatFillTheSameSpace) {
  EXPECT_EQ(clusters({scattered(500, 1), scattered(2000, 2), scattered(1000, 3)}), (Clusters{{0, 1, 2}}));
}

TEST_P(MergeClusters, KeepsMeshesApartThatDoNotOverlap) {
  EXPECT_EQ(clusters({scattered(500, 1), scattered(500, 2, {2, 0, 0}), scattered(500, 3, {0, 3, 0})}), Clusters{});
}

TEST_P(MergeClusters, FormsAClusterPerPartOfTheSpace) {
  Clusters found =
      clusters({scattered(400, 1), scattered(400, 2, {5, 0, 0}), scattered(400, 3), scattered(400, 4, {5, 0, 0})});
  std::ranges::sort(found);
  EXPECT_EQ(found, (Clusters{{0, 2}, {1, 3}}));
}

// The triangles of the room would lie as deep in a tree of halves as the small ones. Other builders place them near the root.
TEST_P(MergeClusters, JoinsAFewLargeTrianglesUnlessTheTreeIsHalved) {
  const bool halving = GetParam() == TreeBuilder::halving;
  EXPECT_EQ(clusters({room(), scattered(50, 1)}), halving ? Clusters{} : (Clusters{{0, 1}}));
}

TEST_P(MergeClusters, SkipsEmptyMeshesAndAcceptsNone) {
  EXPECT_EQ(clusters({}), Clusters{});
  EXPECT_EQ(clusters({{}, scattered(100, 1)}), Clusters{});
  EXPECT_EQ(clusters({{}, scattered(100, 1), {}, scattered(100, 2)}), (Clusters{{1, 3}}));
}

}  // namespace
}  // namespace quintet::rt
