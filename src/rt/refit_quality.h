// SPDX-License-Identifier: Apache-2.0
// How good the tree of a refitted BLAS still is. A refit keeps the tree of the build and only adapts its boxes, which
// grow and overlap when the primitives move apart.
#ifndef QUINTET_RT_REFIT_QUALITY_H
#define QUINTET_RT_REFIT_QUALITY_H

#include <cstdint>
#include <vector>

#include "rt/blas_input.h"

namespace quintet::rt {

// The measure is the cost of halvingTreeCost() (build_cost.h): the summed surface area of all boxes of a tree
// divided by that of its root, which is the expected number of boxes that a ray through the root meets. The tree halves
// the spatial order of the build. With drivers that keep the input order it is the tree of the driver; elsewhere it
// stands for the driver's tree, which is not known.
class RefitQuality {
 public:
  // For a BLAS that is built from this input now.
  explicit RefitQuality(const BlasInput& built);
  // Cost with moved primitives divided by the cost at the build: 1 without motion, also if the whole mesh moves, turns
  // or scales. `moved` has the counts of the build.
  double growth(const BlasInput& moved) const;

  // For the same measure on the device: primitives of all geometries in the order of the tree, and its cost.
  const std::vector<std::uint32_t>& order() const { return order_; }
  double builtCost() const { return builtCost_; }

 private:
  std::vector<std::uint32_t> order_;
  double builtCost_ = 0;
};

// A BLAS is built again if the growth is larger: then rays take longer by about this factor, more than a build costs.
inline constexpr double kMaxRefitGrowth = 1.3;

}  // namespace quintet::rt
#endif
