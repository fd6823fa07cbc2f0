// SPDX-License-Identifier: Apache-2.0
// The layout of graphs: boxes do not overlap, edges point to the right except in cycles, and lines avoid boxes.
#include "check/diagram/layered_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace quintet::check {
namespace {

constexpr LayoutSize kBox{100, 40};

bool overlap(LayoutPoint a, LayoutSize aSize, LayoutPoint b, LayoutSize bSize) {
  return a.x < b.x + bSize.width && b.x < a.x + aSize.width && a.y < b.y + bSize.height && b.y < a.y + aSize.height;
}

TEST(LayeredLayout, PutsAChainInARow) {
  const Layout layout = layoutLayers({kBox, kBox, kBox}, {{0, 1}, {1, 2}}, {50, 20});
  EXPECT_EQ(layout.size.width, 400);
  EXPECT_EQ(layout.size.height, 40);
  EXPECT_EQ(layout.nodes[2].x, 300);
  ASSERT_EQ(layout.edges[0].size(), 2u);
  EXPECT_EQ(layout.edges[0][0].x, 100);
  EXPECT_EQ(layout.edges[0][1].x, 150);
  EXPECT_EQ(layout.edges[0][1].y, 20);
}

TEST(LayeredLayout, CentersANodeBetweenItsNeighbors) {
  const Layout layout = layoutLayers({kBox, kBox, kBox}, {{0, 1}, {0, 2}}, {50, 20});
  EXPECT_NEAR(layout.nodes[0].y, 0.5 * (layout.nodes[1].y + layout.nodes[2].y), 1e-6);
}

TEST(LayeredLayout, LeadsEdgesOfCyclesBack) {
  const Layout layout = layoutLayers({kBox, kBox}, {{0, 1}, {1, 0}});
  EXPECT_LT(layout.nodes[0].x, layout.nodes[1].x);
  EXPECT_EQ(layout.edges[1].front().x, layout.nodes[1].x);
  EXPECT_EQ(layout.edges[1].back().x, layout.nodes[0].x + kBox.width);
}

TEST(LayeredLayout, AvoidsCrossings) {
  // Two chains whose nodes are listed in different orders.
  const Layout layout = layoutLayers({kBox, kBox, kBox, kBox}, {{0, 3}, {1, 2}});
  EXPECT_EQ(layout.nodes[0].y < layout.nodes[1].y, layout.nodes[3].y < layout.nodes[2].y);
}

TEST(LayeredLayout, AcceptsGraphsWithoutEdgesOrNodes) {
  EXPECT_EQ(layoutLayers({}, {}).size.width, 0);
  EXPECT_TRUE(layoutLayers({kBox, kBox}, {}).edges.empty());
}

TEST(LayeredLayout, NeitherBoxesNorLinesOverlap) {
  std::mt19937 random(7);
  for (int graph = 0; graph < 50; ++graph) {
    std::vector<LayoutSize> nodes;
    std::vector<LayoutEdge> edges;
    const std::size_t count = 2 + random() % 14;
    for (std::size_t i = 0; i < count; ++i)
      nodes.push_back({50.0 + static_cast<double>(random() % 200), 20.0 + static_cast<double>(random() % 100)});
    for (std::size_t i = 0; i < 2 * count; ++i)
      if (const LayoutEdge edge{random() % count, random() % count}; edge.from != edge.to) edges.push_back(edge);
    const Layout layout = layoutLayers(nodes, edges);
    for (std::size_t a = 0; a < count; ++a) {
      EXPECT_GE(layout.nodes[a].x, 0);
      EXPECT_GE(layout.nodes[a].y, -1e-6);
      EXPECT_LE(layout.nodes[a].x + nodes[a].width, layout.size.width + 1e-6);
      EXPECT_LE(layout.nodes[a].y + nodes[a].height, layout.size.height + 1e-6);
      for (std::size_t b = a + 1; b < count; ++b)
        EXPECT_FALSE(overlap(layout.nodes[a], nodes[a], layout.nodes[b], nodes[b])) << "graph " << graph;
    }
    for (const std::vector<LayoutPoint>& path : layout.edges)
      for (std::size_t i = 1; i + 1 < path.size(); i += 2)
        for (std::size_t node = 0; node < count; ++node)
          EXPECT_FALSE(overlap(layout.nodes[node], nodes[node], {std::min(path[i].x, path[i + 1].x), path[i].y},
                               {std::abs(path[i].x - path[i + 1].x), 0}))
              << "graph " << graph;
  }
}

}  // namespace
}  // namespace quintet::check
