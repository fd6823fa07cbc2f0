// SPDX-License-Identifier: Apache-2.0
#include "render/film/film_error.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "base/statistics.h"
#include "render/film/fixed_sum.h"

namespace quintet::render {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = 0.1;  // ε relative to the mean luminance
constexpr double kConfidence = 0.95;
constexpr double kTilePercentile = 0.95;
constexpr int kNeighborDistance = 2;  // largest distance in rows and columns of the pixels in referenceLuminance()

double percentile(std::vector<double> values, double part) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::size_t>(part * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(at));
  return values[at];
}

// Computes the errors of the image and of the tiles from those of the cells.
void combineCells(ErrorEstimate& estimate) {
  ErrorSums sums;
  for (const CellError& cell : estimate.cells) sums.add(cell);
  std::vector<double> tiles(estimate.cells.size() / 2);
  parallelRanges(
      tiles.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
          ErrorSums tile;
          tile.add(estimate.cells[2 * t]);
          tile.add(estimate.cells[2 * t + 1]);
          tiles[t] = tile.upper();
        }
      },
      64);
  estimate.image = sums.estimate();
  estimate.upper = sums.upper();
  estimate.tiles = percentile(std::move(tiles), kTilePercentile);
}

}  // namespace

void ErrorSums::add(const CellError& cell) {
  pixels += cell.pixels;
  squares += cell.squares;
  fourths += cell.fourths;
  fourthsByDegree += cell.fourths / (static_cast<double>(cell.batches) - 1.0);
}

double ErrorSums::estimate() const { return std::sqrt(squares / pixels); }

double ErrorSums::marginSquared() const {
  return squares > 0 ? fisherQuantile(kConfidence, squares * squares / fourths, squares * squares / fourthsByDegree)
                     : 1.0;
}

double ErrorSums::upper() const { return std::sqrt(marginSquared() * squares / pixels); }

ErrorEstimator::ErrorEstimator(const Region& region, const SampleCounts& counts)
    : shape_{region, counts, {}, {}}, moments_(shape_.pixelCount()) {
  for (std::uint32_t c = 0; c < 2 * tileCount(region); ++c) known_ = known_ && counts.batchesOf(c) >= 2;
}

ErrorEstimator::Moments ErrorEstimator::momentsOf(const FilmPlane& plane, std::size_t pixel, double samples,
                                                  double batches) {
  double variance = 0;
  double mean[3];
  for (std::size_t c = 0; c < 3; ++c) {
    mean[c] = fixedToDouble(plane.sums[4 * pixel + c]) / samples;
    const double part = varianceOfMean(plane, 4 * pixel + c, samples, batches);
    variance += std::isnan(part) ? kInfinite : part / 3.0;  // NaN: squares exceed their range
  }
  return {static_cast<float>(0.2126 * mean[0] + 0.7152 * mean[1] + 0.0722 * mean[2]), static_cast<float>(variance)};
}

void ErrorEstimator::add(const FilmState& strip, std::uint32_t firstRow) {
  const FilmPlane& plane = strip.planes.at(0);
  known_ = known_ && !plane.squares.empty();
  if (!known_) return;
  parallelFor(strip.region.height, [&](std::size_t y) {
    for (std::uint32_t x = 0; x < strip.region.width; ++x) {
      const std::uint32_t cell = strip.cellOf(x, static_cast<std::uint32_t>(y));
      moments_[(firstRow + y) * strip.region.width + x] =
          momentsOf(plane, y * strip.region.width + x, static_cast<double>(strip.counts.samplesOf(cell)),
                    static_cast<double>(strip.counts.batchesOf(cell)));
    }
  });
}

double ErrorEstimator::referenceLuminance(std::uint32_t x, std::uint32_t y) const {
  const auto width = static_cast<int>(shape_.region.width), height = static_cast<int>(shape_.region.height);
  const auto at = [&](int px, int py) -> const Moments& {
    return moments_[static_cast<std::size_t>(py) * shape_.region.width + static_cast<std::size_t>(px)];
  };
  const auto px = static_cast<int>(x), py = static_cast<int>(y);
  const float luminance = std::abs(at(px, py).luminance), deviation = std::sqrt(at(px, py).variance);
  float sum = 0;
  int count = 0;
  for (int dy = -kNeighborDistance; dy <= kNeighborDistance; ++dy)
    for (int dx = -kNeighborDistance + (dy & 1); dx <= kNeighborDistance; dx += 2) {  // pixels of the same parity
      const bool inside = px + dx >= 0 && px + dx < width && py + dy >= 0 && py + dy < height;
      if (!inside || (dx == 0 && dy == 0)) continue;
      const float other = std::abs(at(px + dx, py + dy).luminance);
      if (!(other <= luminance + deviation)) continue;  // brighter, or NaN
      sum += other;
      ++count;
    }
  if (count == 0) return static_cast<double>(luminance);
  const float neighborhood = sum / static_cast<float>(count);
  return static_cast<double>(std::min(luminance, std::max(neighborhood, luminance - deviation)));
}

bool ErrorEstimator::addTileRow(std::uint32_t row, const std::array<double, 2>& epsilonSquared,
                                std::vector<CellError>& cells) const {
  bool known = true;
  const std::uint32_t end = std::min((row + 1) * shared::kTileSize, shape_.region.height);
  for (std::uint32_t y = row * shared::kTileSize; y < end; ++y)
    for (std::uint32_t x = 0; x < shape_.region.width; ++x) {
      const Moments& pixel = moments_[std::size_t{y} * shape_.region.width + x];
      const std::uint32_t index = shape_.cellOf(x, y);
      CellError& cell = cells[index];
      ++cell.pixels;
      if (std::isnan(pixel.luminance)) continue;  // a defect of the program, reported as Q002
      const double reference = referenceLuminance(x, y);
      const double square = static_cast<double>(pixel.variance) / (reference * reference + epsilonSquared[index & 1u]);
      known = known && !std::isinf(square);
      if (std::isinf(square)) continue;
      cell.squares += square;
      cell.fourths += square * square;
    }
  return known;
}

std::array<double, 2> ErrorEstimator::epsilonSquared() const {
  std::array<double, 2> sums{}, counts{};
  for (std::uint32_t y = 0; y < shape_.region.height; ++y)
    for (std::uint32_t x = 0; x < shape_.region.width; ++x) {
      const Moments& pixel = moments_[std::size_t{y} * shape_.region.width + x];
      const std::uint32_t parity = (x + y) & 1u;
      ++counts[parity];
      sums[parity] += std::isfinite(pixel.luminance) ? static_cast<double>(pixel.luminance) : 0.0;
    }
  std::array<double, 2> result{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double mean = sums[i] / std::max(1.0, counts[i]);
    result[i] = std::max(kEpsilon * kEpsilon * mean * mean, std::numeric_limits<double>::min());
  }
  return result;
}

ErrorEstimate ErrorEstimator::estimate() const {
  ErrorEstimate estimate;
  estimate.cells.resize(2 * std::size_t{tileCount(shape_.region)});
  for (std::size_t c = 0; c < estimate.cells.size(); ++c)
    estimate.cells[c].batches = shape_.counts.batchesOf(static_cast<std::uint32_t>(c));
  const auto isNan = [](const Moments& pixel) { return std::isnan(pixel.luminance); };
  if (!known_ || std::ranges::all_of(moments_, isNan)) return estimate;
  const std::array<double, 2> epsilon = epsilonSquared();
  std::atomic<bool> unknown{false};
  const std::size_t tileRows = tileCount(shape_.region) / tileColumns(shape_.region.width);
  parallelFor(tileRows, [&](std::size_t row) {
    if (!addTileRow(static_cast<std::uint32_t>(row), epsilon, estimate.cells)) unknown = true;
  });
  combineCells(estimate);
  if (unknown) estimate.image = estimate.upper = estimate.tiles = kInfinite;
  return estimate;
}

ErrorEstimate estimateError(const FilmState& film) {
  ErrorEstimator estimator(film.region, film.counts);
  estimator.add(film, 0);
  return estimator.estimate();
}

}  // namespace quintet::render
