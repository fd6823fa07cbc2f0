// A spatially coherent order of primitives or instances for builders that keep the input order
// (lavapipe: the tree halves the index range; docs/design/quirks.md).
#ifndef QUINTET_RT_SPATIAL_ORDER_H
#define QUINTET_RT_SPATIAL_ORDER_H

#include <cstdint>
#include <span>
#include <vector>

#include "base/math.h"

namespace quintet::rt {

// A permutation of [0, bounds.size()): element k is the index of the box that comes k-th. Splitting
// the range at (first+last)/2 again and again gives compact halves.
std::vector<std::uint32_t> spatialOrder(std::span<const Bounds3> bounds);

}  // namespace quintet::rt
#endif
