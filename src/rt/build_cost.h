// SPDX-License-Identifier: Apache-2.0
// What a ray costs in the bounding volume hierarchies that drivers build, to choose among inputs of a build on the host. The
// cost is the expected number of boxes that a random ray through the root intersects: the sum of the surface areas of all
// nodes, divided by that of the root (Goldsmith and Salmon 1987). Leaves contain one box.
#ifndef QUINTET_RT_BUILD_COST_H
#define QUINTET_RT_BUILD_COST_H

#include <cstdint>
#include <span>

#include "base/math.h"

namespace quintet::rt {

enum class TreeBuilder {
  halving,      // halves the index range (Quirks::keepsPrimitiveOrder)
  surfaceArea,  // any builder that minimizes the cost, such as PLOC
};

// Returns the cost of the halving tree over boxes[order[0]], …; 0 without boxes.
double halvingTreeCost(std::span<const Bounds3> bounds, std::span<const std::uint32_t> order);

// Returns the cost of the tree that a builder makes of these finite boxes; for `halving`, in their spatialOrder().
double treeCost(std::span<const Bounds3> bounds, TreeBuilder builder);

}  // namespace quintet::rt
#endif
