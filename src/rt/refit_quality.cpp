// SPDX-License-Identifier: Apache-2.0
#include "rt/refit_quality.h"

#include <cassert>
#include <cmath>

#include "base/parallel.h"
#include "rt/build_cost.h"
#include "rt/spatial_order.h"

namespace quintet::rt {
namespace {

// Of all geometries, in their order.
std::vector<Bounds3> boundsOf(const BlasInput& input) {
  std::vector<Bounds3> bounds;
  for (const GeometryInput& geometry : input.geometries) {
    const std::size_t first = bounds.size();
    bounds.resize(first + primitiveCount(geometry));
    parallelRanges(primitiveCount(geometry), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) bounds[first + i] = primitiveBounds(geometry, i);
    });
  }
  return bounds;
}

}  // namespace

RefitQuality::RefitQuality(const BlasInput& built) {
  const std::vector<Bounds3> bounds = boundsOf(built);
  std::vector<std::size_t> counts;
  for (const GeometryInput& geometry : built.geometries) counts.push_back(primitiveCount(geometry));
  order_ = spatialOrder(bounds, counts);
  builtCost_ = halvingTreeCost(bounds, order_);
}

double RefitQuality::growth(const BlasInput& moved) const {
  const std::vector<Bounds3> bounds = boundsOf(moved);
  assert(bounds.size() == order_.size());
  const double growth = halvingTreeCost(bounds, order_) / builtCost_;
  return std::isfinite(growth) ? growth : 1.0;
}

}  // namespace quintet::rt
