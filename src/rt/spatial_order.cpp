// Recursive median split: each node tries the three axes on a sample of its boxes and takes the one
// whose halves have the smallest surface areas (the surface area heuristic with equal counts).
#include "rt/spatial_order.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "base/parallel.h"

namespace quintet::rt {
namespace {

constexpr std::size_t kSample = 256;         // boxes that choose a node's axis
constexpr std::size_t kSerialRange = 16384;  // smaller subtrees are one task

struct Item {
  vec3 min;
  vec3 max;
  std::uint32_t index;
};

struct Range {
  std::size_t first = 0, last = 0;  // [first, last)
  std::size_t size() const { return last - first; }
  std::size_t middle() const { return first + (size() + 1) / 2; }
};

auto byCenter(int axis) {
  return [axis](const Item& a, const Item& b) { return a.min[axis] + a.max[axis] < b.min[axis] + b.max[axis]; };
}

float areaOf(std::span<const Item> items) {
  vec3 low = items[0].min, high = items[0].max;
  for (const Item& item : items.subspan(1)) low = glm::min(low, item.min), high = glm::max(high, item.max);
  const vec3 e = high - low;
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

class Splitter {
 public:
  Splitter(std::span<Item> items, std::vector<Range> groups) : items_(items), groups_(std::move(groups)) {}

  // Moves the boxes of the group that the middle falls into so that it divides them spatially.
  void split(Range node) const {
    const std::size_t middle = node.middle();
    const Range group = groupAt(middle);
    const Range movable{std::max(node.first, group.first), std::min(node.last, group.last)};
    if (middle == movable.first) return;  // between two groups: nothing to choose
    const std::span<Item> items = items_.subspan(movable.first, movable.size());
    const std::size_t left = middle - movable.first;
    const auto at = [&](std::size_t k) { return items.begin() + static_cast<std::ptrdiff_t>(k); };
    std::nth_element(at(0), at(left), items.end(), byCenter(bestAxis(items, left)));
  }

  void splitAll(Range node) const {
    while (node.size() > 2) {  // in log depth: the smaller half is never the larger one's caller
      split(node);
      splitAll({node.first, node.middle()});
      node.first = node.middle();
    }
  }

 private:
  Range groupAt(std::size_t position) const {
    return *(std::ranges::upper_bound(groups_, position, {}, &Range::first) - 1);
  }

  static int bestAxis(std::span<const Item> items, std::size_t left) {
    std::array<Item, kSample> sample;
    const std::size_t count = std::min(items.size(), kSample);
    for (std::size_t k = 0; k < count; ++k) sample[k] = items[k * items.size() / count];
    const std::size_t sampleLeft = std::clamp<std::size_t>(left * count / items.size(), 1, count - 1);
    const std::span<const Item> leftHalf(sample.data(), sampleLeft);
    const std::span<const Item> rightHalf(sample.data() + sampleLeft, count - sampleLeft);
    int best = 0;
    float bestCost = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      std::nth_element(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(sampleLeft),
                       sample.begin() + static_cast<std::ptrdiff_t>(count), byCenter(axis));
      const float cost = areaOf(leftHalf) * static_cast<float>(leftHalf.size()) +
                         areaOf(rightHalf) * static_cast<float>(rightHalf.size());
      if (cost < bestCost) best = axis, bestCost = cost;
    }
    return best;
  }

  std::span<Item> items_;
  std::vector<Range> groups_;  // not empty, sorted
};

std::vector<Item> itemsOf(std::span<const Bounds3> bounds) {
  std::vector<Item> items(bounds.size());
  for (std::size_t k = 0; k < bounds.size(); ++k) {
    const bool usable = isFinite(bounds[k].min) && isFinite(bounds[k].max);  // a NaN would break the sorting
    items[k] = {usable ? bounds[k].min : vec3(0), usable ? bounds[k].max : vec3(0), static_cast<std::uint32_t>(k)};
  }
  return items;
}

// One level of the tree after the other, its nodes in parallel, then the subtrees in parallel.
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

double sumOfAreas(std::span<const Bounds3> bounds, std::span<const std::uint32_t> order, Bounds3& whole) {
  if (order.size() == 1) {
    whole = bounds[order[0]];
    return whole.area();
  }
  const std::size_t left = (order.size() + 1) / 2;
  Bounds3 other;
  const double sum = sumOfAreas(bounds, order.first(left), whole) + sumOfAreas(bounds, order.subspan(left), other);
  whole.extend(other);
  return sum + whole.area();
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
  std::vector<Item> items = itemsOf(bounds);
  order(Splitter(items, std::move(groups)), items.size());
  for (std::size_t k = 0; k < items.size(); ++k) result[k] = items[k].index;
  return result;
}

double halvingTreeCost(std::span<const Bounds3> bounds, std::span<const std::uint32_t> order) {
  if (order.empty()) return 0.0;
  Bounds3 whole;
  const double sum = sumOfAreas(bounds, order, whole);
  return whole.area() > 0.0f ? sum / whole.area() : 0.0;
}

}  // namespace quintet::rt
