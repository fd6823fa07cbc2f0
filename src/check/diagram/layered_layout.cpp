// SPDX-License-Identifier: Apache-2.0
#include "check/diagram/layered_layout.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace quintet::check {
namespace {

using Indices = std::vector<std::size_t>;

constexpr int kOrderSweeps = 24, kPositionSweeps = 24;
constexpr double kLaneHeight = 8;  // of an edge that passes a column

class LayeredLayout {
 public:
  LayeredLayout(const std::vector<LayoutSize>& sizes, const std::vector<LayoutEdge>& edges, const LayoutGaps& gaps)
      : sizes_(sizes), edges_(edges), gaps_(gaps), count_(sizes.size()) {}

  Layout run() {
    findCycles();
    assignLayers();
    splitLongEdges();
    orderLayers();
    placeRows();
    return draw();
  }

 private:
  // Reverses the edges that close a cycle in a depth-first search.
  void findCycles() {
    reversed_.assign(edges_.size(), false);
    std::vector<int> state(count_, 0);  // 0 new, 1 on the path, 2 done
    for (std::size_t node = 0; node < count_; ++node) visit(node, state);
  }

  void visit(std::size_t node, std::vector<int>& state) {
    if (state[node] != 0) return;
    state[node] = 1;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      assert(edges_[e].from != edges_[e].to);
      if (edges_[e].from != node) continue;
      if (state[edges_[e].to] == 1)
        reversed_[e] = true;
      else
        visit(edges_[e].to, state);
    }
    state[node] = 2;
  }

  LayoutEdge forward(std::size_t e) const {
    return reversed_[e] ? LayoutEdge{edges_[e].to, edges_[e].from} : edges_[e];
  }

  // The layer of a node is the length of the longest path to it.
  void assignLayers() {
    layer_.assign(count_, 0);
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t e = 0; e < edges_.size(); ++e) {
        const auto [from, to] = forward(e);
        if (layer_[to] > layer_[from]) continue;
        layer_[to] = layer_[from] + 1;
        changed = true;
      }
    }
  }

  // Edges over several layers get a vertex in each layer that they pass.
  void splitLongEdges() {
    heights_.clear();
    for (const LayoutSize& size : sizes_) heights_.push_back(size.height);
    chains_.assign(edges_.size(), {});
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const auto [from, to] = forward(e);
      Indices& chain = chains_[e];
      chain.push_back(from);
      for (std::size_t layer = layer_[from] + 1; layer < layer_[to]; ++layer) {
        chain.push_back(layer_.size());
        layer_.push_back(layer);
        heights_.push_back(kLaneHeight);
      }
      chain.push_back(to);
    }
    left_.assign(layer_.size(), {});
    right_.assign(layer_.size(), {});
    for (const Indices& chain : chains_) {
      for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        right_[chain[i]].push_back(chain[i + 1]);
        left_[chain[i + 1]].push_back(chain[i]);
      }
    }
    std::size_t last = 0;
    for (const std::size_t layer : layer_) last = std::max(last, layer);
    layers_.assign(count_ == 0 ? 0 : last + 1, {});
    for (std::size_t vertex = 0; vertex < layer_.size(); ++vertex) layers_[layer_[vertex]].push_back(vertex);
  }

  // Sorts each layer by the mean rank of the neighbors, in both directions, and keeps the order with the fewest crossings.
  void orderLayers() {
    std::vector<Indices> best = layers_;
    std::size_t fewest = crossings();
    for (int sweep = 0; sweep < kOrderSweeps && fewest > 0; ++sweep) {
      if (sweep % 2 == 0)
        for (std::size_t i = 1; i < layers_.size(); ++i) sortLayer(i, left_);
      else
        for (std::size_t i = layers_.size() - 1; i-- > 0;) sortLayer(i, right_);
      const std::size_t now = crossings();
      if (now < fewest) fewest = now, best = layers_;
    }
    layers_ = best;
  }

  std::vector<double> ranks() const {
    std::vector<double> rank(layer_.size());
    for (const Indices& layer : layers_)
      for (std::size_t i = 0; i < layer.size(); ++i) rank[layer[i]] = static_cast<double>(i);
    return rank;
  }

  void sortLayer(std::size_t index, const std::vector<Indices>& neighbors) {
    const std::vector<double> rank = ranks();
    const auto mean = [&](std::size_t vertex) {
      const Indices& list = neighbors[vertex];
      if (list.empty()) return rank[vertex];
      return std::accumulate(list.begin(), list.end(), 0.0,
                             [&](double sum, std::size_t other) { return sum + rank[other]; }) /
             static_cast<double>(list.size());
    };
    std::ranges::stable_sort(layers_[index], {}, mean);
  }

  std::size_t crossings() const {
    const std::vector<double> rank = ranks();
    std::size_t result = 0;
    for (const Indices& layer : layers_)
      for (std::size_t i = 0; i < layer.size(); ++i)
        for (std::size_t k = i + 1; k < layer.size(); ++k)
          for (const std::size_t a : right_[layer[i]])
            result += static_cast<std::size_t>(
                std::ranges::count_if(right_[layer[k]], [&](std::size_t b) { return rank[b] < rank[a]; }));
    return result;
  }

  // Moves each vertex toward the mean height of its neighbors, as far as the order and the gaps allow.
  void placeRows() {
    center_.assign(layer_.size(), 0);
    for (const Indices& layer : layers_) {
      double y = 0;
      for (const std::size_t vertex : layer) {
        center_[vertex] = y + 0.5 * heights_[vertex];
        y += heights_[vertex] + gaps_.row;
      }
    }
    for (int sweep = 0; sweep < kPositionSweeps; ++sweep)
      for (std::size_t i = 0; i < layers_.size(); ++i) placeLayer(layers_[sweep % 2 == 0 ? i : layers_.size() - 1 - i]);
    double top = 0;
    for (std::size_t vertex = 0; vertex < layer_.size(); ++vertex)
      top = std::min(top, center_[vertex] - 0.5 * heights_[vertex]);
    for (double& center : center_) center -= top;
  }

  // Least squares under minimum distances, by pooling adjacent violators: after subtracting the distances, the positions
  // must be ascending.
  void placeLayer(const Indices& layer) {
    struct Pool {
      double sum = 0;
      std::size_t count = 0;
      double mean() const { return sum / static_cast<double>(count); }
    };
    std::vector<Pool> pools;
    std::vector<double> offsets;
    double offset = 0;
    for (std::size_t i = 0; i < layer.size(); ++i) {
      if (i > 0) offset += 0.5 * (heights_[layer[i - 1]] + heights_[layer[i]]) + gaps_.row;
      offsets.push_back(offset);
      pools.push_back({wanted(layer[i]) - offset, 1});
      while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
        const Pool last = pools.back();
        pools.pop_back();
        pools.back().sum += last.sum;
        pools.back().count += last.count;
      }
    }
    std::size_t i = 0;
    for (const Pool& pool : pools)
      for (std::size_t k = 0; k < pool.count; ++k, ++i) center_[layer[i]] = pool.mean() + offsets[i];
  }

  double wanted(std::size_t vertex) const {
    double sum = 0;
    std::size_t count = 0;
    for (const auto* neighbors : {&left_[vertex], &right_[vertex]})
      for (const std::size_t other : *neighbors) sum += center_[other], ++count;
    return count > 0 ? sum / static_cast<double>(count) : center_[vertex];
  }

  Layout draw() const {
    Layout layout;
    std::vector<double> x(layers_.size()), width(layers_.size(), 0);
    for (std::size_t vertex = 0; vertex < count_; ++vertex)
      width[layer_[vertex]] = std::max(width[layer_[vertex]], sizes_[vertex].width);
    for (std::size_t i = 1; i < x.size(); ++i) x[i] = x[i - 1] + width[i - 1] + gaps_.column;
    layout.nodes.resize(count_);
    for (std::size_t vertex = 0; vertex < layer_.size(); ++vertex) {
      const double bottom = center_[vertex] + 0.5 * heights_[vertex];
      layout.size.height = std::max(layout.size.height, bottom);
      if (vertex < count_) layout.nodes[vertex] = {x[layer_[vertex]], bottom - heights_[vertex]};
    }
    layout.size.width = x.empty() ? 0 : x.back() + width.back();
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const Indices& chain = chains_[e];
      std::vector<LayoutPoint> path;
      for (std::size_t i = 0; i < chain.size(); ++i) {
        const std::size_t vertex = chain[i], layer = layer_[vertex];
        const double end = x[layer] + (vertex < count_ ? sizes_[vertex].width : width[layer]);
        if (i > 0) path.push_back({x[layer], port(e, i, left_[vertex].size(), false)});
        if (i + 1 < chain.size()) path.push_back({end, port(e, i, right_[vertex].size(), true)});
      }
      if (reversed_[e]) std::ranges::reverse(path);
      layout.edges.push_back(std::move(path));
    }
    return layout;
  }

  // The height at which an edge meets a side of its vertex number `i`: ports are sorted by the heights of the other ends.
  double port(std::size_t edge, std::size_t i, std::size_t count, bool right) const {
    const std::size_t vertex = chains_[edge][i];
    if (vertex >= count_ || count < 2) return center_[vertex];
    const auto other = [&](std::size_t e) {
      const Indices& chain = chains_[e];
      return center_[right ? chain[1] : chain[chain.size() - 2]];
    };
    std::size_t rank = 0;
    for (std::size_t e = 0; e < chains_.size(); ++e) {
      if (e == edge || (right ? chains_[e].front() : chains_[e].back()) != vertex) continue;
      if (other(e) < other(edge) || (other(e) == other(edge) && e < edge)) ++rank;
    }
    const double step = heights_[vertex] / static_cast<double>(count + 1);
    return center_[vertex] - 0.5 * heights_[vertex] + step * static_cast<double>(rank + 1);
  }

  const std::vector<LayoutSize>& sizes_;
  const std::vector<LayoutEdge>& edges_;
  const LayoutGaps gaps_;
  const std::size_t count_;  // vertices from here on are those of long edges
  std::vector<bool> reversed_;
  Indices layer_;                      // of each vertex
  std::vector<double> heights_;        // of each vertex
  std::vector<Indices> chains_;        // the vertices of each edge, from left to right
  std::vector<Indices> left_, right_;  // neighbors of each vertex
  std::vector<Indices> layers_;        // vertices in order
  std::vector<double> center_;         // height of each vertex
};

}  // namespace

Layout layoutLayers(const std::vector<LayoutSize>& nodes, const std::vector<LayoutEdge>& edges,
                    const LayoutGaps& gaps) {
  return LayeredLayout(nodes, edges, gaps).run();
}

}  // namespace quintet::check
