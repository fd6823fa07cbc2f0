// SPDX-License-Identifier: Apache-2.0
#include "render/scene/tree_cost.h"

#include <bit>
#include <cmath>

#include "quintet/shared/frame.h"
#include "quintet/shared/pass.h"
#include "render/compute_pass.h"

namespace quintet::render {

static_assert(sizeof(shared::TreeCostPass) <= shared::kPushConstantBytes);

TreeCost::TreeCost(gpu::Context& context, const rt::BlasInput& built,
                   std::vector<shared::TreeCostGeometry> geometries) {
  const rt::RefitQuality quality(built);
  builtCost_ = quality.builtCost();
  const auto count = static_cast<std::uint32_t>(quality.order().size());
  if (count == 0) return;
  order_ = gpu::makeBufferOf(context, quality.order(), 0, "tree order");
  geometries_ = gpu::makeBufferOf(context, geometries, 0, "tree geometries");

  shared::TreeCostList list{};
  list.order = order_.address();
  list.geometries = geometries_.address();
  list.triangleCount = count;
  list.geometryCount = static_cast<std::uint32_t>(geometries.size());
  list.depth = static_cast<std::uint32_t>(std::bit_width(count - 1));
  list_ = gpu::makeBufferOf(context, std::vector{list}, 0, "tree list");
  shared::TreeCostPass pass{};
  pass.list = list_.address();
  std::vector<std::uint64_t> firstRoots;
  std::uint64_t nodes = 0, leaves = std::uint64_t{1} << list.depth;
  do {
    pass.leafCount = static_cast<std::uint32_t>(leaves);
    levels_.push_back(pass);
    firstRoots.push_back(nodes);
    leaves = (leaves + shared::kTreeCostLeaves - 1) / shared::kTreeCostLeaves;
    nodes += leaves;
  } while (leaves > 1);
  nodes_ = gpu::Buffer(context, {.size = nodes * sizeof(shared::TreeCostNode), .name = "tree nodes"});
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    levels_[level].roots = nodes_.address() + firstRoots[level] * sizeof(shared::TreeCostNode);
    if (level > 0) levels_[level].leaves = levels_[level - 1].roots;
  }
}

void TreeCost::record(gpu::Commands& commands, const gpu::ComputePipeline& pass, std::size_t level,
                      shared::Address result) const {
  shared::TreeCostPass constants = levels_[level];
  if (level + 1 == levels_.size()) constants.roots = result;
  dispatchPass(pass, commands, std::as_bytes(std::span(&constants, 1)),
               (constants.leafCount + (1u << shared::kTreeCostSerialDepth) - 1) >> shared::kTreeCostSerialDepth);
}

double TreeCost::growth(const shared::TreeCostNode& root) const {
  const Bounds3 bounds{root.low, root.high};
  const double growth = double{root.cost} / double{bounds.area()} / builtCost_;
  return std::isfinite(growth) ? growth : 1.0;
}

}  // namespace quintet::render
