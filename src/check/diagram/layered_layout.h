// SPDX-License-Identifier: Apache-2.0
// A layered layout of a directed graph: columns from left to right, so that most edges point to the right. After Sugiyama,
// Tagawa and Toda, "Methods for Visual Understanding of Hierarchical System Structures", 1981.
#ifndef QUINTET_CHECK_DIAGRAM_LAYERED_LAYOUT_H
#define QUINTET_CHECK_DIAGRAM_LAYERED_LAYOUT_H

#include <cstddef>
#include <vector>

namespace quintet::check {

struct LayoutSize {
  double width = 0, height = 0;
};

struct LayoutPoint {
  double x = 0, y = 0;
};

struct LayoutEdge {
  std::size_t from = 0, to = 0;
};

struct Layout {
  std::vector<LayoutPoint> nodes;  // top left corners
  // For each edge the points from the box of `from` to that of `to`. Points 2k to 2k+1 are a curve between two columns,
  // points 2k+1 to 2k+2 a horizontal line through a column. Edges of cycles start at the left and end at the right.
  std::vector<std::vector<LayoutPoint>> edges;
  LayoutSize size;
};

struct LayoutGaps {
  double column = 90, row = 22;
};

// Deterministic. Loops of a node to itself are not supported.
Layout layoutLayers(const std::vector<LayoutSize>& nodes, const std::vector<LayoutEdge>& edges,
                    const LayoutGaps& gaps = {});

}  // namespace quintet::check
#endif
