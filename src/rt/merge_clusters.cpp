// SPDX-License-Identifier: Apache-2.0
#include "rt/merge_clusters.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

namespace quintet::rt {
namespace {

// Cost of entering a tree, relative to testing the boxes of a node: the instance and its nodes in the top level. Measured
// (docs/measurements.md).
constexpr double kEnterCost = 6.0;
constexpr double kMaxRatio = 0.9;          // of the cost of one tree to that of two
constexpr float kMinOverlap = 0.25f;       // of the smaller surface area, that of the intersection of two boxes
constexpr std::size_t kMaxWork = 2000000;  // comparisons, and boxes of trees that are tried

struct Cluster {
  std::vector<std::uint32_t> meshes;
  std::vector<Bounds3> boxes;
  Bounds3 bounds;
  double cost = 0;  // expected number of boxes that a random ray intersects, times a constant
};

double costOf(const Cluster& cluster, TreeBuilder builder) {
  return static_cast<double>(cluster.bounds.area()) * (kEnterCost + treeCost(cluster.boxes, builder));
}

Cluster clusterOf(std::uint32_t mesh, const std::vector<Bounds3>& boxes, TreeBuilder builder) {
  Cluster cluster{{mesh}, boxes, {}, 0};
  for (const Bounds3& box : boxes) cluster.bounds.extend(box);
  cluster.cost = costOf(cluster, builder);
  return cluster;
}

Cluster joined(const Cluster& a, const Cluster& b, TreeBuilder builder) {
  Cluster both = a;
  both.meshes.insert(both.meshes.end(), b.meshes.begin(), b.meshes.end());
  both.boxes.insert(both.boxes.end(), b.boxes.begin(), b.boxes.end());
  both.bounds.extend(b.bounds);
  both.cost = costOf(both, builder);
  return both;
}

bool overlap(const Bounds3& a, const Bounds3& b) {
  const Bounds3 common{glm::max(a.min, b.min), glm::min(a.max, b.max)};
  return common.area() > kMinOverlap * std::min(a.area(), b.area());
}

}  // namespace

std::vector<std::vector<std::uint32_t>> mergeClusters(std::span<const std::vector<Bounds3>> meshes,
                                                      TreeBuilder builder) {
  std::vector<std::uint32_t> order(meshes.size());
  std::iota(order.begin(), order.end(), 0u);
  // Small meshes first: they join each other before a large mesh is there, which few of them may fit.
  std::ranges::stable_sort(order, {}, [&](std::uint32_t mesh) { return meshes[mesh].size(); });
  std::vector<Cluster> clusters;
  std::size_t work = 0;
  for (const std::uint32_t mesh : order) {
    if (meshes[mesh].empty()) continue;
    Cluster added = clusterOf(mesh, meshes[mesh], builder);
    std::optional<Cluster> best;
    std::size_t bestIndex = 0;
    double bestGain = 0;
    for (std::size_t k = 0; k < clusters.size() && work < kMaxWork; ++k, ++work) {
      if (!overlap(clusters[k].bounds, added.bounds)) continue;
      Cluster both = joined(clusters[k], added, builder);
      work += both.boxes.size();
      const double separate = clusters[k].cost + added.cost;
      if (both.cost >= kMaxRatio * separate || separate - both.cost <= bestGain) continue;
      bestGain = separate - both.cost;
      bestIndex = k;
      best = std::move(both);
    }
    if (best)
      clusters[bestIndex] = std::move(*best);
    else
      clusters.push_back(std::move(added));
  }
  std::vector<std::vector<std::uint32_t>> result;
  for (Cluster& cluster : clusters) {
    if (cluster.meshes.size() < 2) continue;
    std::ranges::sort(cluster.meshes);
    result.push_back(std::move(cluster.meshes));
  }
  return result;
}

}  // namespace quintet::rt
