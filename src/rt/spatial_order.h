// A spatially coherent order of primitives or instances for builders that keep the input order
// (lavapipe: the tree halves the index range; docs/design/quirks.md).
#ifndef QUINTET_RT_SPATIAL_ORDER_H
#define QUINTET_RT_SPATIAL_ORDER_H

#include <cstdint>
#include <span>
#include <vector>

#include "base/math.h"

namespace quintet::rt {

// A permutation of [0, bounds.size()): element k is the index of the box that comes k-th. Halving the
// index range again and again gives compact halves; of an odd count the left half gets one more, as
// in lavapipe, whose last index is inclusive: (first + last) / 2. Boxes should be finite (others
// count as a point in the origin). The result does not depend on the number of threads.
std::vector<std::uint32_t> spatialOrder(std::span<const Bounds3> bounds);

// The same for consecutive groups (the geometries of one BLAS, which share one tree): every box stays
// within the index range of its group. The sizes add up to bounds.size().
std::vector<std::uint32_t> spatialOrder(std::span<const Bounds3> bounds, std::span<const std::size_t> groupSizes);

// Surface areas of all nodes of the tree that halves the index range over boxes[order[0]], …, divided
// by the root's: the expected number of boxes that a ray through the root meets (Goldsmith and Salmon,
// 1987). The measure by which orders are compared.
double halvingTreeCost(std::span<const Bounds3> bounds, std::span<const std::uint32_t> order);

}  // namespace quintet::rt
#endif
