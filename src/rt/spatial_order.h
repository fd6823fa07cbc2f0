// SPDX-License-Identifier: Apache-2.0
// A spatially coherent order of primitives or instances for drivers that build a tree over the input order by halving
// the index range (Quirks::keepsPrimitiveOrder).
#ifndef QUINTET_RT_SPATIAL_ORDER_H
#define QUINTET_RT_SPATIAL_ORDER_H

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/math.h"

namespace quintet::rt {

// Returns a permutation of [0, bounds.size()): element k is the index of the k-th box. Halving the index range
// recursively gives compact halves. The left half of an odd count has one more box, as in lavapipe, where the last
// index is inclusive: (first + last) / 2. Non-finite boxes are treated as a point at the origin. The result does not
// depend on the number of threads.
std::vector<std::uint32_t> spatialOrder(std::span<const Bounds3> bounds);

// The same for consecutive groups, the geometries of one BLAS, which share one tree: each box stays within the index
// range of its group. The sum of the sizes is bounds.size().
std::vector<std::uint32_t> spatialOrder(std::span<const Bounds3> bounds, std::span<const std::size_t> groupSizes);

}  // namespace quintet::rt
#endif
