// SPDX-License-Identifier: Apache-2.0
#include "render/film/adaptive_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quintet::render {
namespace {

constexpr std::uint32_t kMaxBatches = 1u << 22;

// Plans the cells 2 · tile + part. Everything that decides comes from the other cells.
class PartPlanner {
 public:
  PartPlanner(const std::vector<CellError>& cells, const CellGoal& goal, std::size_t part);
  // Writes the limits of the planned cells.
  void plan(std::vector<std::uint32_t>& limits) const;

 private:
  // Mean number of batches per pixel, and the mean square error that they reach.
  struct Outcome {
    double batches = 0;
    double square = 0;
  };
  // Returns the number of batches of cell c if they are `factor` times its standard deviation.
  std::uint32_t limit(std::size_t c, double factor) const;
  Outcome outcome(double factor) const;
  // Returns the smallest factor that reaches the target error, or the largest that stays within the number of batches.
  double findFactor() const;

  const std::vector<CellError>& cells_;
  const CellGoal goal_;
  const std::size_t part_;
  std::vector<double> spread_;         // relative variance of one batch, estimated from the other cell of the tile
  std::vector<double> marginSquared_;  // ErrorSums::marginSquared of that other cell
  double pixels_ = 0;
  double largestSpread_ = 1e-30;
  double target_ = 0;  // the target error, less the margin that the confidence takes
};

PartPlanner::PartPlanner(const std::vector<CellError>& cells, const CellGoal& goal, std::size_t part)
    : cells_(cells), goal_(goal), part_(part), spread_(cells.size()), marginSquared_(cells.size(), 1.0) {
  double mean = 0;
  ErrorSums others;
  for (std::size_t c = part; c < cells.size(); c += 2) {
    const CellError& other = cells[c ^ 1u].pixels > 0 ? cells[c ^ 1u] : cells[c];
    if (other.pixels > 0) spread_[c] = other.squares / other.pixels * static_cast<double>(other.batches);
    if (other.pixels > 0) others.add(other);
    if (goal.error > 0 && other.pixels > 0) {
      ErrorSums sums;
      sums.add(other);
      marginSquared_[c] = sums.marginSquared();
    }
    pixels_ += cells[c].pixels;
    mean += cells[c].pixels * spread_[c];
  }
  if (pixels_ == 0) return;
  // A cell whose samples show no noise can still have some: it gets at least one hundredth of the mean spread.
  for (std::size_t c = part; c < cells.size(); c += 2)
    largestSpread_ = std::max(largestSpread_, spread_[c] = std::max(spread_[c], 0.01 * mean / pixels_));
  const double ratio = goal.error > 0 ? others.estimate() / others.upper() : 1.0;
  target_ = goal.error * (std::isfinite(ratio) ? std::min(1.0, ratio) : 1.0);
}

std::uint32_t PartPlanner::limit(std::size_t c, double factor) const {
  double batches = factor * std::sqrt(spread_[c]);
  if (goal_.error > 0) batches = std::max(batches, marginSquared_[c] * spread_[c] / (4.0 * goal_.error * goal_.error));
  const double least = static_cast<double>(cells_[c].batches);
  return static_cast<std::uint32_t>(
      std::clamp(std::ceil(batches), least, std::max(least, static_cast<double>(kMaxBatches))));
}

PartPlanner::Outcome PartPlanner::outcome(double factor) const {
  Outcome result;
  for (std::size_t c = part_; c < cells_.size(); c += 2) {
    const std::uint32_t batches = limit(c, factor);
    result.batches += static_cast<double>(cells_[c].pixels) * batches / pixels_;
    result.square += cells_[c].pixels * spread_[c] / batches / pixels_;
  }
  return result;
}

double PartPlanner::findFactor() const {
  double low = 0, high = static_cast<double>(kMaxBatches) / std::sqrt(largestSpread_);
  for (int i = 0; i < 100; ++i) {
    const double factor = 0.5 * (low + high);
    const Outcome reached = outcome(factor);
    const bool over = goal_.batches > 0 && reached.batches > goal_.batches;
    const bool enough = goal_.error > 0 && reached.square <= target_ * target_;
    (over || enough ? high : low) = factor;
  }
  return goal_.error > 0 ? high : low;
}

void PartPlanner::plan(std::vector<std::uint32_t>& limits) const {
  if (pixels_ == 0) return;
  const double factor = findFactor();
  for (std::size_t c = part_; c < cells_.size(); c += 2) limits[c] = cells_[c].pixels > 0 ? limit(c, factor) : 0;
  // If the target is out of reach, the number of batches alone decides.
  const bool tooMany = goal_.error > 0 && goal_.batches > 0 && outcome(factor).batches > goal_.batches;
  if (tooMany) PartPlanner(cells_, {0, goal_.batches}, part_).plan(limits);
}

}  // namespace

std::vector<std::uint32_t> planCells(const ErrorEstimate& estimate, const CellGoal& goal) {
  std::vector<std::uint32_t> limits(estimate.cells.size());
  for (const std::size_t part : {std::size_t{0}, std::size_t{1}}) PartPlanner(estimate.cells, goal, part).plan(limits);
  return limits;
}

AdaptiveBatches nextAdaptiveBatches(const Region& region, const SampleCounts& counts,
                                    const std::vector<std::uint32_t>& limits, bool one) {
  AdaptiveBatches next;
  next.counts = counts.cellBatches;
  if (next.counts.empty()) next.counts.assign(limits.size(), static_cast<std::uint32_t>(counts.batches()));
  const auto remains = [&](std::size_t cell) { return next.counts[cell] < limits[cell]; };
  const auto isComplete = [&](std::uint32_t tile) { return !remains(2 * tile) && !remains(2 * tile + 1); };
  std::vector<std::uint32_t> pending;
  for (std::uint32_t tile = 0; tile < limits.size() / 2; ++tile)
    if (!isComplete(tile)) pending.push_back(tile);
  const std::uint32_t columns = tileColumns(region.width), space = tileCount(region);
  while (!pending.empty() && next.tiles.size() < space) {
    std::uint32_t batch = std::numeric_limits<std::uint32_t>::max();
    for (const std::uint32_t tile : pending)
      for (const std::uint32_t cell : {2 * tile, 2 * tile + 1})
        if (remains(cell)) batch = std::min(batch, next.counts[cell]);
    for (const std::uint32_t t : pending) {
      if (next.tiles.size() == space) break;
      shared::FilmTile tile{t % columns * shared::kTileSize, t / columns * shared::kTileSize, {}, batch};
      for (std::uint32_t c = 0; c < 2; ++c) {
        tile.drawn[c] = next.counts[2 * t + c] == batch && remains(2 * t + c) ? 1 : 0;
        next.counts[2 * t + c] += tile.drawn[c];
      }
      if (tile.drawn[0] + tile.drawn[1] > 0) next.tiles.push_back(tile);
    }
    if (one) break;
    std::erase_if(pending, isComplete);
  }
  return next;
}

}  // namespace quintet::render
