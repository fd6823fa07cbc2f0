#include "render/film_error.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "base/statistics.h"
#include "render/fixed_sum.h"

namespace quintet::render {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kDarkness = 0.1;  // ε, of the mean luminance
constexpr double kConfidence = 0.95;
constexpr double kTilesBelow = 0.95;
constexpr int kReach = 2;  // of the pixels that a pixel is compared with
constexpr std::uint32_t kMostBatches = 1u << 22;

double percentile(std::vector<double> values, double part) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::size_t>(part * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(at));
  return values[at];
}

// Sums over pixels: of squares v, of v², and of v² over the degrees of freedom by which each v is known.
struct ErrorSums {
  double pixels = 0, squares = 0, fourths = 0, doubt = 0;
  void add(const CellError& cell) {
    pixels += cell.pixels;
    squares += cell.squares;
    fourths += cell.fourths;
    doubt += cell.fourths / (static_cast<double>(cell.batches) - 1.0);
  }
  double image() const { return std::sqrt(squares / pixels); }
  // The square of a bound over the square of the estimate: Satterthwaite 1946 for both sums of squares; black pictures
  // have none.
  double room() const {
    return squares > 0 ? fisherQuantile(kConfidence, squares * squares / fourths, squares * squares / doubt) : 1.0;
  }
  double upper() const { return std::sqrt(room() * squares / pixels); }
};

double roomOf(const CellError& cell) {
  ErrorSums sums;
  sums.add(cell);
  return sums.room();
}

void conclude(ErrorEstimate& estimate) {
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
  estimate.image = sums.image();
  estimate.upper = sums.upper();
  estimate.tiles = percentile(std::move(tiles), kTilesBelow);
}

}  // namespace

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
    variance += std::isnan(part) ? kInfinite : part / 3.0;  // squares beyond their range: nothing is known
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

double ErrorEstimator::weightOf(std::uint32_t x, std::uint32_t y) const {
  const auto width = static_cast<int>(shape_.region.width), height = static_cast<int>(shape_.region.height);
  const auto at = [&](int px, int py) -> const Moments& {
    return moments_[static_cast<std::size_t>(py) * shape_.region.width + static_cast<std::size_t>(px)];
  };
  const auto px = static_cast<int>(x), py = static_cast<int>(y);
  const float luminance = std::abs(at(px, py).luminance), deviation = std::sqrt(at(px, py).variance);
  float sum = 0;
  int count = 0;
  for (int dy = -kReach; dy <= kReach; ++dy)
    for (int dx = -kReach + (dy & 1); dx <= kReach; dx += 2) {  // those of the same cells
      const bool inside = px + dx >= 0 && px + dx < width && py + dy >= 0 && py + dy < height;
      if (!inside || (dx == 0 && dy == 0)) continue;
      const float other = std::abs(at(px + dx, py + dy).luminance);
      if (!(other <= luminance + deviation)) continue;  // brighter, or not a number
      sum += other;
      ++count;
    }
  if (count == 0) return static_cast<double>(luminance);
  const float around = sum / static_cast<float>(count);
  return static_cast<double>(std::min(luminance, std::max(around, luminance - deviation)));
}

bool ErrorEstimator::addTileRow(std::uint32_t row, const std::array<double, 2>& darkness,
                                std::vector<CellError>& cells) const {
  bool known = true;
  const std::uint32_t end = std::min((row + 1) * shared::kTileSize, shape_.region.height);
  for (std::uint32_t y = row * shared::kTileSize; y < end; ++y)
    for (std::uint32_t x = 0; x < shape_.region.width; ++x) {
      const Moments& pixel = moments_[std::size_t{y} * shape_.region.width + x];
      const std::uint32_t index = shape_.cellOf(x, y);
      CellError& cell = cells[index];
      ++cell.pixels;
      if (std::isnan(pixel.luminance)) continue;  // a defect of the program that is told elsewhere
      const double weight = weightOf(x, y);
      const double square = static_cast<double>(pixel.variance) / (weight * weight + darkness[index & 1u]);
      known = known && !std::isinf(square);
      if (std::isinf(square)) continue;
      cell.squares += square;
      cell.fourths += square * square;
    }
  return known;
}

ErrorEstimate ErrorEstimator::estimate() const {
  const auto forPixels = [&](const auto& use) {
    for (std::uint32_t y = 0; y < shape_.region.height; ++y)
      for (std::uint32_t x = 0; x < shape_.region.width; ++x)
        use(moments_[std::size_t{y} * shape_.region.width + x], shape_.cellOf(x, y));
  };
  ErrorEstimate estimate;
  estimate.cells.resize(2 * std::size_t{tileCount(shape_.region)});
  for (std::size_t c = 0; c < estimate.cells.size(); ++c)
    estimate.cells[c].batches = shape_.counts.batchesOf(static_cast<std::uint32_t>(c));
  if (!known_) return estimate;
  // Of the pixels with even x + y, and of the others: what decides about a cell must know nothing of its own samples.
  std::array<double, 2> darkness{}, count{};
  forPixels([&](const Moments& pixel, std::uint32_t cell) {
    ++count[cell & 1u];
    darkness[cell & 1u] += std::isfinite(pixel.luminance) ? static_cast<double>(pixel.luminance) : 0.0;
  });
  for (std::size_t i = 0; i < 2; ++i) {
    const double mean = darkness[i] / std::max(1.0, count[i]);
    darkness[i] = std::max(kDarkness * kDarkness * mean * mean, std::numeric_limits<double>::min());
  }
  std::atomic<bool> unknown{false};
  const std::size_t tileRows = tileCount(shape_.region) / tileColumns(shape_.region.width);
  parallelFor(tileRows, [&](std::size_t row) {
    if (!addTileRow(static_cast<std::uint32_t>(row), darkness, estimate.cells)) unknown = true;
  });
  conclude(estimate);
  if (unknown) estimate.image = estimate.upper = estimate.tiles = kInfinite;
  return estimate;
}

ErrorEstimate estimateError(const FilmState& film) {
  ErrorEstimator estimator(film.region, film.counts);
  estimator.add(film, 0);
  return estimator.estimate();
}

namespace {

// The numbers of the cells 2 · tile + `part`. All that decides comes from the other cells.
void planPart(const std::vector<CellError>& cells, const CellGoal& goal, std::size_t part,
              std::vector<std::uint32_t>& limits) {
  std::vector<double> spread(cells.size());      // relative variance of one batch, by the other cell
  std::vector<double> rooms(cells.size(), 1.0);  // ErrorSums::room of the other cell
  double pixels = 0, mean = 0, widest = 1e-30;
  ErrorSums others;
  for (std::size_t c = part; c < cells.size(); c += 2) {
    const CellError& other = cells[c ^ 1u].pixels > 0 ? cells[c ^ 1u] : cells[c];
    if (other.pixels > 0) spread[c] = other.squares / other.pixels * static_cast<double>(other.batches);
    if (other.pixels > 0) others.add(other);
    if (goal.error > 0 && other.pixels > 0) rooms[c] = roomOf(other);
    pixels += cells[c].pixels;
    mean += cells[c].pixels * spread[c];
  }
  if (pixels == 0) return;
  // Where nothing was found yet, something may be: one part in a hundred of the mean.
  for (std::size_t c = part; c < cells.size(); c += 2)
    widest = std::max(widest, spread[c] = std::max(spread[c], 0.01 * mean / pixels));
  // The room that the confidence takes is taken off the goal.
  const double ratio = goal.error > 0 ? others.image() / others.upper() : 1.0;
  const double aim = goal.error * (std::isfinite(ratio) ? std::min(1.0, ratio) : 1.0);
  const auto limit = [&](std::size_t c, double factor) {
    double batches = factor * std::sqrt(spread[c]);
    if (goal.error > 0) batches = std::max(batches, rooms[c] * spread[c] / (4.0 * goal.error * goal.error));
    const double least = static_cast<double>(cells[c].batches);
    return static_cast<std::uint32_t>(
        std::clamp(std::ceil(batches), least, std::max(least, static_cast<double>(kMostBatches))));
  };
  const auto total = [&](double factor, double& square) {
    double sum = 0;
    square = 0;
    for (std::size_t c = part; c < cells.size(); c += 2) {
      const std::uint32_t batches = limit(c, factor);
      sum += static_cast<double>(cells[c].pixels) * batches / pixels;
      square += cells[c].pixels * spread[c] / batches / pixels;
    }
    return sum;
  };
  // The smallest factor that reaches the error, or the largest that keeps within the batches.
  double low = 0, high = static_cast<double>(kMostBatches) / std::sqrt(widest);
  for (int i = 0; i < 100; ++i) {
    const double factor = 0.5 * (low + high);
    double square;
    const double batches = total(factor, square);
    const bool over = goal.batches > 0 && batches > goal.batches;
    const bool reached = goal.error > 0 && square <= aim * aim;
    (over || reached ? high : low) = factor;
  }
  for (std::size_t c = part; c < cells.size(); c += 2)
    limits[c] = cells[c].pixels > 0 ? limit(c, goal.error > 0 ? high : low) : 0;
  // Out of reach: as good as so many batches make it.
  double unused;
  const bool tooMany = goal.error > 0 && goal.batches > 0 && total(high, unused) > goal.batches;
  if (tooMany) planPart(cells, {0, goal.batches}, part, limits);
}

}  // namespace

std::vector<std::uint32_t> planCells(const ErrorEstimate& estimate, const CellGoal& goal) {
  std::vector<std::uint32_t> limits(estimate.cells.size());
  for (const std::size_t part : {std::size_t{0}, std::size_t{1}}) planPart(estimate.cells, goal, part, limits);
  return limits;
}

}  // namespace quintet::render
