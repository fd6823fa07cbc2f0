// SPDX-License-Identifier: Apache-2.0
#include "render/lights/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <unordered_map>

#include "base/parallel.h"

namespace quintet::render {
namespace {

constexpr std::size_t kChunk = 16384;       // lights that one task bins
constexpr std::size_t kLargeRange = 65536;  // larger ranges are split one after the other, each on all cores
constexpr std::size_t kSubtree = 2048;      // largest number of lights whose subtree one task builds
constexpr int kHalvingDepth = 64;           // deeper ranges are split in half, which bounds the depth of the recursion

using Lights = std::span<LightTreeInput>;

// The lights of a bin. Its cone is around the axis of the first light, which is fast and good enough to compare splits.
struct Bin {
  Bounds3 box;
  double intensity = 0.0;
  vec3 axis{0, 0, 1};
  float cosine = 1.0f;  // cosine of the largest angle between `axis` and the axis of a light
  float thetaO = 0.0f;  // largest thetaO of a light
  float thetaE = 0.0f;
  bool twoSided = false;
  std::uint32_t count = 0;

  void add(const LightBounds& b) {
    if (count++ == 0) axis = b.axis;
    box.extend(b.box);
    intensity += b.intensity;
    twoSided |= b.twoSided;
    const float along = glm::dot(axis, b.axis);
    cosine = std::min(cosine, b.twoSided ? std::abs(along) : along);
    thetaO = std::max(thetaO, b.thetaO);
    thetaE = std::max(thetaE, b.thetaE);
  }
  LightBounds bounds() const {
    LightBounds b;
    b.box = box;
    b.intensity = static_cast<float>(intensity);
    b.axis = axis;
    b.thetaO = std::min(kPi, std::acos(std::max(-1.0f, cosine)) + thetaO);
    b.thetaE = thetaE;
    b.twoSided = twoSided;
    return b;
  }
};

// Per axis and bin; an empty bin has intensity 0.
template <std::size_t kBins>
using Rows = std::array<std::array<LightBounds, kBins>, 3>;

double cost(const LightBounds& b) {
  const vec3 extent = b.box.extent();
  return static_cast<double>(b.intensity) * glm::dot(extent, extent) * orientationMeasure(b);
}

void add(LightBounds& sum, const LightBounds& more) {
  if (more.intensity > 0.0f) sum = sum.intensity > 0.0f ? unite(sum, more) : more;
}

// Split of a range of lights. The first part has the lights whose center is in a bin up to `bin` along `axis`. axis 3
// means that the range is split in half.
struct Split {
  glm::length_t axis = 3;
  std::size_t bin = 0;
};

template <std::size_t kBins>
struct Binning {
  vec3 low, scale;
  explicit Binning(const Bounds3& centers) : low(centers.min) {
    const vec3 extent = centers.extent();
    for (glm::length_t i = 0; i < 3; ++i) scale[i] = extent[i] > 0.0f ? static_cast<float>(kBins) / extent[i] : 0.0f;
  }
  std::size_t of(const LightBounds& b, glm::length_t axis) const {
    const float center = 0.5f * b.box.min[axis] + 0.5f * b.box.max[axis];
    const float at = (center - low[axis]) * scale[axis];
    return std::min(kBins - 1, static_cast<std::size_t>(std::max(0.0f, at)));
  }
};

template <std::size_t kBins>
void fillRows(Lights lights, const Binning<kBins>& binning, Rows<kBins>& rows) {
  std::array<std::array<Bin, kBins>, 3> bins;
  for (const LightTreeInput& light : lights)
    for (glm::length_t axis = 0; axis < 3; ++axis)
      if (binning.scale[axis] > 0.0f)
        bins[static_cast<std::size_t>(axis)][binning.of(light.bounds, axis)].add(light.bounds);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t bin = 0; bin < kBins; ++bin)
      if (bins[axis][bin].count > 0) add(rows[axis][bin], bins[axis][bin].bounds());
}

// Bins in chunks that do not depend on the number of cores.
template <std::size_t kBins>
Rows<kBins> fillRows(Lights lights, const Binning<kBins>& binning) {
  Rows<kBins> rows;
  if (lights.size() <= kChunk) {
    fillRows(lights, binning, rows);
    return rows;
  }
  std::vector<Rows<kBins>> parts((lights.size() + kChunk - 1) / kChunk);
  parallelFor(parts.size(), [&](std::size_t part) {
    fillRows(lights.subspan(part * kChunk, std::min(kChunk, lights.size() - part * kChunk)), binning, parts[part]);
  });
  for (const Rows<kBins>& part : parts)
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t bin = 0; bin < kBins; ++bin) add(rows[axis][bin], part[axis][bin]);
  return rows;
}

// Returns the cheapest split between bins by equation 2, regularized by the extents.
template <std::size_t kBins>
Split cheapest(const Rows<kBins>& rows, const vec3& extent) {
  const float longest = std::max({extent.x, extent.y, extent.z});
  Split best;
  double least = std::numeric_limits<double>::infinity();
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    if (!(extent[axis] > 0.0f)) continue;
    const auto& row = rows[static_cast<std::size_t>(axis)];
    std::array<double, kBins> above{};  // cost of the bins from i to the end; negative if they are empty
    LightBounds right, left;
    for (std::size_t i = kBins; i-- > 1;) {
      above[i] = i + 1 < kBins ? above[i + 1] : -1.0;
      if (!(row[i].intensity > 0.0f)) continue;
      add(right, row[i]);
      above[i] = cost(right);
    }
    const double regular = static_cast<double>(longest) / extent[axis];
    for (std::size_t i = 0; i + 1 < kBins; ++i) {
      if (!(row[i].intensity > 0.0f)) continue;  // a split after an empty bin equals the split before it
      add(left, row[i]);
      if (above[i + 1] < 0.0) break;
      const double sum = regular * (cost(left) + above[i + 1]);
      if (sum < least) {
        least = sum;
        best = {axis, i};
      }
    }
  }
  return best;
}

// Moves the lights of the first part of the cheapest split to the front, and returns their number.
template <std::size_t kBins>
std::size_t splitAtBin(Lights lights, const Bounds3& centers) {
  const Binning<kBins> binning(centers);
  const Split best = cheapest<kBins>(fillRows(lights, binning), centers.extent());
  if (best.axis == 3) return lights.size() / 2;
  const auto isFirst = [&](const LightTreeInput& light) { return binning.of(light.bounds, best.axis) <= best.bin; };
  return static_cast<std::size_t>(std::partition(lights.begin(), lights.end(), isFirst) - lights.begin());
}

// Moves the lights with power to the end of the list and returns them: environments, directional lights, and finite
// lights, each in their order. There are few infinite lights, so the others are moved only once.
Lights sortByReach(std::vector<LightTreeInput>& lights) {
  std::vector<LightTreeInput> infinite;
  std::size_t first = lights.size();
  for (std::size_t i = lights.size(); i-- > 0;) {
    if (!(lights[i].bounds.intensity > 0.0f)) continue;
    if (lights[i].reach != LightReach::finite)
      infinite.push_back(lights[i]);
    else if (--first != i)
      lights[first] = lights[i];
  }
  std::ranges::stable_sort(infinite, std::ranges::less{}, &LightTreeInput::reach);  // the last one is the first light
  for (const LightTreeInput& light : infinite) lights[--first] = light;
  return Lights(lights).subspan(first);
}

class Builder {
 public:
  Builder(Lights lights, LightTree& tree) : lights_(lights), nodes_(tree.nodes), leaves_(tree.leaves) {
    environments_ = countReach(LightReach::environment);
    infinite_ = environments_ + countReach(LightReach::directional);
  }

  void run() {
    const Range all{0, lights_.size(), 0, 2, 0};
    std::vector<Range> ranges;
    splitLarge(all, ranges);
    // A range adds its parts as tasks, until they are small enough.
    parallelTasks(std::move(ranges), [&](const Range& range, TaskList<Range>& list) {
      if (range.count <= kSubtree && reachBorder(range) == 0) return record(range, {0, build(range)});
      const std::size_t count = split(range);
      record(range, {count, {}});
      list.add(secondChild(range, count));
      list.add(firstChild(range, count));
    });
    finish(all);
  }

 private:
  struct Range {
    std::size_t first, count;
    std::size_t node;   // index of the range's node
    std::size_t below;  // index of its first child; all descendants follow
    int depth;
  };
  // A range that was split, or whose subtree is complete.
  struct Result {
    std::size_t firstCount = 0;  // of a range that was split: size of the first part
    LightBounds bounds;          // of a complete subtree
  };

  std::size_t countReach(LightReach reach) const {
    return static_cast<std::size_t>(std::ranges::count(lights_, reach, &LightTreeInput::reach));
  }

  static Range firstChild(const Range& r, std::size_t count) {
    return {r.first, count, r.below, r.below + 2, r.depth + 1};
  }
  static Range secondChild(const Range& r, std::size_t count) {
    return {r.first + count, r.count - count, r.below + 1, r.below + 2 * count, r.depth + 1};
  }

  // Returns the number of lights before the first change of reach within the range, or 0 if all have the same reach.
  // Such ranges are split there.
  std::size_t reachBorder(const Range& r) const {
    for (const std::size_t border : {infinite_, environments_})
      if (r.first < border && border < r.first + r.count) return border - r.first;
    return 0;
  }

  // Sorts the range into two parts and returns the size of the first.
  std::size_t split(const Range& r) {
    if (const std::size_t border = reachBorder(r)) return border;
    if (r.depth >= kHalvingDepth || r.count <= 2) return r.count / 2;
    const Lights lights = lights_.subspan(r.first, r.count);
    Bounds3 centers;
    for (const LightTreeInput& light : lights) centers.extend(light.bounds.box.center());
    if (r.count < 32) return splitAtBin<4>(lights, centers);
    if (r.count < 512) return splitAtBin<8>(lights, centers);
    return splitAtBin<12>(lights, centers);
  }

  void splitLarge(const Range& r, std::vector<Range>& ranges) {
    if (r.count <= kLargeRange) return ranges.push_back(r);
    const std::size_t count = split(r);
    record(r, {count, {}});
    splitLarge(firstChild(r, count), ranges);
    splitLarge(secondChild(r, count), ranges);
  }

  void record(const Range& r, const Result& result) {
    const std::scoped_lock lock(mutex_);
    results_[r.node] = result;
  }

  LightBounds build(const Range& r) {
    if (r.count == 1) {
      leaves_[lights_[r.first].light] = static_cast<std::uint32_t>(r.node);
      return write(r, lights_[r.first].bounds, shared::kLightNodeLeaf | lights_[r.first].light);
    }
    const std::size_t count = split(r);
    const LightBounds first = build(firstChild(r, count));
    const LightBounds second = build(secondChild(r, count));
    return write(r, unite(first, second), static_cast<std::uint32_t>(r.below));
  }

  // Writes the nodes above the complete subtrees.
  LightBounds finish(const Range& r) {
    const Result& result = results_.at(r.node);
    if (result.firstCount == 0) return result.bounds;
    const LightBounds first = finish(firstChild(r, result.firstCount));
    const LightBounds second = finish(secondChild(r, result.firstCount));
    if (reachBorder(r) > 0) nodes_[r.below].link |= shared::kLightNodeShare;
    return write(r, unite(first, second), static_cast<std::uint32_t>(r.below));
  }

  LightBounds write(const Range& r, const LightBounds& bounds, std::uint32_t link) {
    shared::LightNode& node = nodes_[r.node];
    node = packLightNode(bounds);
    node.link |= link;
    if (r.first < infinite_) node.link |= shared::kLightNodeInfinite;
    return bounds;
  }

  Lights lights_;
  std::vector<shared::LightNode>& nodes_;
  std::vector<std::uint32_t>& leaves_;
  std::size_t environments_ = 0;  // number of environments, which come first
  std::size_t infinite_ = 0;      // number of environments and directional lights, which come next
  std::mutex mutex_;
  std::unordered_map<std::size_t, Result> results_;  // by node
};

std::uint32_t packAxis(const vec3& n) {
  vec2 v = vec2(n) / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  if (n.z < 0.0f)
    v = vec2((1.0f - std::abs(v.y)) * (v.x >= 0.0f ? 1.0f : -1.0f),
             (1.0f - std::abs(v.x)) * (v.y >= 0.0f ? 1.0f : -1.0f));
  return glm::packSnorm2x16(v);
}

// Returns the largest 16-bit snorm that is not above the cosine.
std::uint32_t packCosine(double cosine) {
  const auto steps = static_cast<int>(std::floor(std::clamp(cosine, -1.0, 1.0) * 32767.0));
  return static_cast<std::uint16_t>(static_cast<std::int16_t>(steps));
}

}  // namespace

void LightTree::build(std::vector<LightTreeInput>& lights, std::size_t lightCount) {
  leaves.assign(lightCount, shared::kNoLight);
  const Lights used = sortByReach(lights);
  nodes.resize(2 * std::max<std::size_t>(used.size(), 1));
  nodes[0] = nodes[1] = {};
  if (used.empty())
    nodes[0].link = shared::kLightNodeLeaf;
  else
    Builder(used, *this).run();
}

vec3 unpackLightAxis(std::uint32_t axis) {
  const vec2 v = glm::unpackSnorm2x16(axis);
  const float z = 1.0f - std::abs(v.x) - std::abs(v.y), fold = std::max(-z, 0.0f);
  return glm::normalize(vec3(v.x + (v.x >= 0.0f ? -fold : fold), v.y + (v.y >= 0.0f ? -fold : fold), z));
}

shared::LightNode packLightNode(const LightBounds& bounds) {
  shared::LightNode node{};
  node.center = bounds.center;
  node.radius = bounds.radius * (1.0f + 1e-5f) +
                4e-7f * (std::abs(node.center.x) + std::abs(node.center.y) + std::abs(node.center.z));
  node.intensity = bounds.intensity;
  node.axis = packAxis(bounds.axis);
  // The cone is widened by the quantization of the axis and by the rounding errors of the unions.
  const vec3 decoded = unpackLightAxis(node.axis);
  const double thetaO = bounds.thetaO + 2e-4 + std::asin(std::min(1.0f, glm::length(glm::cross(decoded, bounds.axis))));
  const double full = bounds.twoSided ? 0.5 * glm::pi<double>() : glm::pi<double>();
  node.cone = packCosine(thetaO >= full ? -1.0 : std::cos(thetaO)) | packCosine(std::cos(bounds.thetaE)) << 16;
  if (bounds.twoSided) node.link |= shared::kLightNodeBothSides;
  return node;
}

}  // namespace quintet::render
