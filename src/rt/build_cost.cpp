// SPDX-License-Identifier: Apache-2.0
#include "rt/build_cost.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "rt/spatial_order.h"

namespace quintet::rt {
namespace {

// The sum of the areas of all nodes of a halving tree; `whole` is the root.
double sumOfHalves(std::span<const Bounds3> bounds, std::span<const std::uint32_t> order, Bounds3& whole) {
  if (order.size() == 1) {
    whole = bounds[order[0]];
    return whole.area();
  }
  const std::size_t left = (order.size() + 1) / 2;
  Bounds3 other;
  const double sum = sumOfHalves(bounds, order.first(left), whole) + sumOfHalves(bounds, order.subspan(left), other);
  whole.extend(other);
  return sum + whole.area();
}

// Splits from top to bottom where the surface area heuristic is smallest (Wald 2007, "On fast Construction of SAH-based
// Bounding Volume Hierarchies").
class BinnedSplitter {
 public:
  explicit BinnedSplitter(std::span<const Bounds3> bounds) : bounds_(bounds), order_(bounds.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
  }

  // Returns the sum of the areas of all nodes.
  double sumOfAreas() {
    double sum = 0;
    std::vector<std::span<std::uint32_t>> open{order_};
    while (!open.empty()) {
      const std::span<std::uint32_t> node = open.back();
      open.pop_back();
      sum += boundsOf(node).area();
      if (node.size() == 1) continue;
      const std::size_t left = split(node);
      open.push_back(node.first(left));
      open.push_back(node.subspan(left));
    }
    return sum;
  }

 private:
  static constexpr std::size_t kBins = 16;

  struct Bin {
    Bounds3 bounds;
    std::size_t count = 0;
    void add(const Bin& other) { bounds.extend(other.bounds), count += other.count; }
    double cost() const { return static_cast<double>(count) * static_cast<double>(bounds.area()); }
  };

  struct Split {
    int axis = 0;
    std::size_t bin = 0;  // the first on the right
    double cost = std::numeric_limits<double>::infinity();
  };

  Bounds3 boundsOf(std::span<const std::uint32_t> node) const {
    Bounds3 whole;
    for (const std::uint32_t k : node) whole.extend(bounds_[k]);
    return whole;
  }

  static std::size_t binOf(const Bounds3& box, const Bounds3& centers, int axis) {
    const float range = centers.max[axis] - centers.min[axis];
    const float position = (box.center()[axis] - centers.min[axis]) / range;
    return static_cast<std::size_t>(std::clamp(position * float(kBins), 0.0f, float(kBins - 1)));
  }

  void tryAxis(std::span<const std::uint32_t> node, const Bounds3& centers, int axis, Split& best) const {
    std::array<Bin, kBins> bins;
    for (const std::uint32_t k : node) bins[binOf(bounds_[k], centers, axis)].add({bounds_[k], 1});
    std::array<double, kBins> rightCost{};
    Bin right;
    for (std::size_t k = kBins - 1; k > 0; --k) {
      right.add(bins[k]);
      rightCost[k] = right.cost();
    }
    Bin left;
    for (std::size_t k = 1; k < kBins; ++k) {
      left.add(bins[k - 1]);
      if (left.count == 0 || left.count == node.size()) continue;
      const double cost = left.cost() + rightCost[k];
      if (cost < best.cost) best = {axis, k, cost};
    }
  }

  // Partitions the node and returns the number of boxes on the left, in the middle if all centers are equal.
  std::size_t split(std::span<std::uint32_t> node) const {
    Bounds3 centers;
    for (const std::uint32_t k : node) centers.extend(bounds_[k].center());
    Split best;
    for (int axis = 0; axis < 3; ++axis)
      if (const float range = centers.max[axis] - centers.min[axis]; range > 0.0f && std::isfinite(range))
        tryAxis(node, centers, axis, best);
    if (best.bin == 0) return node.size() / 2;
    const auto isLeft = [&](std::uint32_t k) { return binOf(bounds_[k], centers, best.axis) < best.bin; };
    // Not std::ranges::partition: Clang 14 does not compile the subranges of libstdc++ 12.
    const auto middle = std::partition(node.begin(), node.end(), isLeft);
    return static_cast<std::size_t>(middle - node.begin());
  }

  std::span<const Bounds3> bounds_;
  std::vector<std::uint32_t> order_;
};

double surfaceAreaTreeCost(std::span<const Bounds3> bounds) {
  Bounds3 whole;
  for (const Bounds3& box : bounds) whole.extend(box);
  return whole.area() > 0.0f ? BinnedSplitter(bounds).sumOfAreas() / whole.area() : 0.0;
}

}  // namespace

double halvingTreeCost(std::span<const Bounds3> bounds, std::span<const std::uint32_t> order) {
  if (order.empty()) return 0.0;
  Bounds3 whole;
  const double sum = sumOfHalves(bounds, order, whole);
  return whole.area() > 0.0f ? sum / whole.area() : 0.0;
}

double treeCost(std::span<const Bounds3> bounds, TreeBuilder builder) {
  if (builder == TreeBuilder::halving) return halvingTreeCost(bounds, spatialOrder(bounds));
  return surfaceAreaTreeCost(bounds);
}

}  // namespace quintet::rt
