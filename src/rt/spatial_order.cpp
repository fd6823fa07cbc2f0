// SPDX-License-Identifier: Apache-2.0
// Recursive median split. Each node uses the axis whose halves have the smallest surface areas (the surface area
// heuristic with equal counts) for a sample of its boxes. Axes with little expected gain are not evaluated, which
// halves the time (0.84 → 0.46 µs per box) and makes the tree less than 2 % worse than evaluating all axes with 256
// boxes.
#include "rt/spatial_order.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <memory>
#include <utility>

#include "base/parallel.h"

namespace quintet::rt {
namespace {

constexpr std::size_t kSample = 128;         // boxes that select the axis of a node
constexpr float kMinGain = 0.6f;             // fraction of the best axis's expected gain
constexpr std::size_t kSerialRange = 16384;  // larger subtrees are split in parallel

struct alignas(16) Item {
  vec3 center;
  std::uint32_t index;
};

// NaN would break sorting. center() adds halves, so it does not overflow.
Item itemOf(const Bounds3& box, std::size_t index) {
  const bool usable = isFinite(box.min) && isFinite(box.max);
  return {usable ? box.center() : vec3(0), static_cast<std::uint32_t>(index)};
}

struct Range {
  std::size_t first = 0, last = 0;  // [first, last)
  std::size_t size() const { return last - first; }
  std::size_t middle() const { return first + (size() + 1) / 2; }
};

auto byCenter(int axis) {
  return [axis](const Item& a, const Item& b) { return a.center[axis] < b.center[axis]; };
}

class Splitter {
 public:
  Splitter(std::span<Item> items, std::span<const Bounds3> bounds, std::vector<Range> groups)
      : items_(items), bounds_(bounds), groups_(std::move(groups)) {}

  // Reorders the boxes of the group that contains the middle so that the middle divides them spatially.
  void split(Range node) const {
    const std::size_t middle = node.middle();
    const Range group = groupAt(middle);
    const Range movable{std::max(node.first, group.first), std::min(node.last, group.last)};
    if (middle == movable.first) return;  // the middle is between two groups
    const std::span<Item> items = items_.subspan(movable.first, movable.size());
    const std::size_t left = middle - movable.first;
    const auto at = [&](std::size_t k) { return items.begin() + static_cast<std::ptrdiff_t>(k); };
    const int axis = bestAxis(items, left);
    std::nth_element(at(0), at(left), items.end(), byCenter(axis));
  }

  void splitAll(Range node) const {
    while (node.size() > 2) {  // recursion of logarithmic depth
      split(node);
      splitAll({node.first, node.middle()});
      node.first = node.middle();
    }
  }

 private:
  Range groupAt(std::size_t position) const {
    return *(std::ranges::upper_bound(groups_, position, {}, &Range::first) - 1);
  }

  // Returns the gain of a split in the middle of each axis: it shortens the boxes of both halves by half of the range
  // of the centers on this axis, so their areas decrease by range · (sum of the other two extents).
  vec3 gainsOf(std::span<const Item> items) const {
    vec3 low(std::numeric_limits<float>::infinity()), high = -low, boxLow = low, boxHigh = high;
    for (const Item& item : items) {
      low = glm::min(low, item.center), high = glm::max(high, item.center);
      boxLow = glm::min(boxLow, bounds_[item.index].min), boxHigh = glm::max(boxHigh, bounds_[item.index].max);
    }
    const vec3 e = boxHigh - boxLow;
    return (high - low) * vec3(e.y + e.z, e.z + e.x, e.x + e.y);
  }

  float areaOf(std::span<const Item> items) const {
    vec3 low(std::numeric_limits<float>::infinity()), high = -low;
    for (const Item& item : items)
      low = glm::min(low, bounds_[item.index].min), high = glm::max(high, bounds_[item.index].max);
    const vec3 e = high - low;
    return e.x * e.y + e.y * e.z + e.z * e.x;
  }

  int bestAxis(std::span<const Item> items, std::size_t left) const {
    std::array<Item, kSample> sample;
    const std::size_t count = std::min(items.size(), kSample);
    for (std::size_t k = 0; k < count; ++k) sample[k] = items[k * items.size() / count];
    const std::span<Item> tried(sample.data(), count);
    const vec3 gains = gainsOf(tried);
    const float minGain = kMinGain * std::max({gains.x, gains.y, gains.z});
    int best = 0, candidates = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (gains[axis] >= minGain) best = axis, ++candidates;
    if (candidates <= 1) return best;
    const std::size_t sampleLeft = std::clamp<std::size_t>(left * count / items.size(), 1, count - 1);
    float bestCost = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (!(gains[axis] >= minGain)) continue;
      std::nth_element(tried.begin(), tried.begin() + static_cast<std::ptrdiff_t>(sampleLeft), tried.end(),
                       byCenter(axis));
      const float cost = areaOf(tried.first(sampleLeft)) * static_cast<float>(sampleLeft) +
                         areaOf(tried.subspan(sampleLeft)) * static_cast<float>(count - sampleLeft);
      if (cost < bestCost) best = axis, bestCost = cost;
    }
    return best;
  }

  std::span<Item> items_;
  std::span<const Bounds3> bounds_;
  std::vector<Range> groups_;  // non-empty groups, sorted
};

// Splits the upper levels one by one, with parallel nodes, then the subtrees in parallel.
void order(const Splitter& splitter, std::size_t count) {
  std::vector<Range> level{{0, count}};
  while (level.front().size() > kSerialRange) {
    parallelFor(level.size(), [&](std::size_t k) { splitter.split(level[k]); });
    std::vector<Range> next;
    for (const Range& node : level) {
      next.push_back({node.first, node.middle()});
      next.push_back({node.middle(), node.last});
    }
    level = std::move(next);
  }
  parallelFor(level.size(), [&](std::size_t k) { splitter.splitAll(level[k]); });
}

}  // namespace

std::vector<std::uint32_t> spatialOrder(std::span<const Bounds3> bounds) {
  const std::size_t all = bounds.size();
  return spatialOrder(bounds, std::span(&all, 1));
}

std::vector<std::uint32_t> spatialOrder(std::span<const Bounds3> bounds, std::span<const std::size_t> groupSizes) {
  std::vector<std::uint32_t> result(bounds.size());
  if (bounds.empty()) return result;
  std::vector<Range> groups;
  std::size_t first = 0;
  for (const std::size_t size : groupSizes) {
    if (size > 0) groups.push_back({first, first + size});
    first += size;
  }
  assert(first == bounds.size());
  const std::unique_ptr<Item[]> items = std::make_unique_for_overwrite<Item[]>(bounds.size());
  parallelRanges(bounds.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) items[k] = itemOf(bounds[k], k);
  });
  order(Splitter({items.get(), bounds.size()}, bounds, std::move(groups)), bounds.size());
  parallelRanges(bounds.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) result[k] = items[k].index;
  });
  return result;
}

}  // namespace quintet::rt
