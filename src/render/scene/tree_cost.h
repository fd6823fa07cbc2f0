// SPDX-License-Identifier: Apache-2.0
// Measures on the device how good the tree of a refitted BLAS is (rt/refit_quality.h), and its bounds, without reading
// vertices on the host.
#ifndef QUINTET_RENDER_SCENE_TREE_COST_H
#define QUINTET_RENDER_SCENE_TREE_COST_H

#include <vector>

#include "gpu/compute.h"
#include "quintet/shared/deform.h"
#include "rt/refit_quality.h"

namespace quintet::render {

// Of one BLAS of triangles. A dispatch reduces subtrees with shared::kTreeCostLeaves leaves to one node, so that a few
// levels reach the root.
class TreeCost {
 public:
  TreeCost() = default;
  // For the BLAS that is built from `built` now; `geometries` has the addresses of its vertices and triangles.
  TreeCost(gpu::Context& context, const rt::BlasInput& built, std::vector<shared::TreeCostGeometry> geometries);

  std::size_t levelCount() const { return levels_.size(); }
  // Records a level. The last one writes the root to `result`, a shared::TreeCostNode. The levels must be recorded in
  // order, with barriers of the stage compute between them.
  void record(gpu::Commands& commands, const gpu::ComputePipeline& pass, std::size_t level,
              shared::Address result) const;
  // Cost of the tree with this root divided by the cost at the build, as RefitQuality::growth().
  double growth(const shared::TreeCostNode& root) const;

 private:
  std::vector<shared::TreeCostPass> levels_;
  gpu::Buffer order_, geometries_, list_, nodes_;
  double builtCost_ = 0;
};

}  // namespace quintet::render
#endif
