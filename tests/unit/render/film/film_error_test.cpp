// SPDX-License-Identifier: Apache-2.0
// The error estimate of films whose samples are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "film_simulation.h"
#include "render/film/adaptive_plan.h"
#include "render/film/film_error.h"

namespace quintet::render {
namespace {

TEST(FilmError, EstimatesTheErrorOfKnownSamples) {
  // Uniform in [0, 2]: mean 1, variance 1/3, and 1/192 for the mean of 64 samples. Relative to Y² + (0.1 · mean)² =
  // 1.01.
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 2);
  FilmSimulation simulation(64, 48);
  simulation.render([&](auto, auto) { return uniform(random); }, 16);
  const ErrorEstimate estimate = estimateError(simulation.film);
  const double exact = std::sqrt(1.0 / 192 / 1.01);
  // The error is relative to at most the pixel's own luminance, so the estimate is slightly larger than the exact
  // value.
  EXPECT_GT(estimate.image, 0.99 * exact);
  EXPECT_LT(estimate.image, (1.0 + exact) * exact);
  EXPECT_GT(estimate.upper, estimate.image);
  EXPECT_LT(estimate.upper, 1.1 * exact);
  EXPECT_NEAR(estimate.tiles, exact, 0.1 * exact);
  EXPECT_TRUE(estimate.reaches(1.1 * exact));
  EXPECT_FALSE(estimate.reaches(0.9 * exact));
}

TEST(FilmError, IsUnknownBelowTwoBatches) {
  FilmSimulation simulation(8, 8);
  simulation.render([](auto, auto) { return 1.0; }, 1);
  EXPECT_TRUE(std::isinf(estimateError(simulation.film).upper));
}

// Strips of tile rows give the same result in any order, with and without adaptive counts.
TEST(FilmError, IsTheSameFromStrips) {
  std::mt19937 random(8);
  const Draw draw = [&](std::uint32_t x, std::uint32_t) {
    return 1.0 + 0.01 * static_cast<double>(random() % 100) * (x < 32 ? 1.0 : 0.1);
  };
  for (const bool adaptive : {false, true}) {
    FilmSimulation simulation(70, 75);
    simulation.render(draw, 4);
    if (adaptive) simulation.complete(draw, planCells(estimateError(simulation.film), {0, 9}));
    const FilmState& film = simulation.film;
    ErrorEstimator estimator(film.region, film.counts);
    for (const std::uint32_t first : {64u, 0u, 32u}) {
      const std::uint32_t rows = std::min(32u, film.region.height - first);
      FilmState strip{{0, first, 70, rows}, countsOfRows(film.counts, 70, first, rows), {film.planes[0]}, {}};
      for (auto* words : {&strip.planes[0].sums, &strip.planes[0].squares})
        *words = {words->begin() + 4 * 70 * first, words->begin() + 4 * 70 * (first + rows)};
      estimator.add(strip, first);
    }
    const ErrorEstimate whole = estimateError(film), strips = estimator.estimate();
    EXPECT_TRUE(whole.known());
    EXPECT_EQ(strips.upper, whole.upper);
    EXPECT_EQ(strips.tiles, whole.tiles);
    for (std::size_t c = 0; c < whole.cells.size(); ++c)
      EXPECT_EQ(strips.cells[c].squares, whole.cells[c].squares) << c;
  }
}

// The bound must be wide enough for noise in a single pixel, and for few batches.
TEST(FilmError, CoversImagesWithFewNoisyPixels) {
  std::mt19937 random(6);
  std::normal_distribution<double> normal(1.0, 0.2);
  for (const std::uint32_t noisy : {1u, 40u})
    for (const std::uint32_t batches : {2u, 4u, 16u}) {
      int covered = 0;
      constexpr int kRuns = 200;
      for (int run = 0; run < kRuns; ++run) {
        FilmSimulation simulation(8, 5);
        double square = 0, sum = 0;
        const Draw draw = [&](std::uint32_t px, std::uint32_t py) {
          return 8 * py + px < noisy ? normal(random) : 1.0;
        };
        simulation.render(draw, batches);
        const io::Image image = planeImage(simulation.film, 0);
        for (std::uint32_t i = 0; i < 40; ++i) sum += static_cast<double>(image.pixel<float>(i % 8, i / 8)[0]) / 40;
        for (std::uint32_t x = 0; x < 40; ++x) {
          const double value = static_cast<double>(image.pixel<float>(x % 8, x / 8)[0]);
          square += (value - 1.0) * (value - 1.0) / (value * value + 0.01 * sum * sum) / 40;
        }
        covered += std::sqrt(square) <= estimateError(simulation.film).upper;
      }
      // 95 % less three standard deviations of 200 runs. An infinite bound would cover everything.
      EXPECT_GE(covered, 181) << noisy << " pixels, " << batches << " batches";
      if (noisy == 40 && batches == 16) {
        EXPECT_LT(covered, 200);
      }
    }
}

// The squares of a pixel that shows the sun in cd/m² exceed the film's range. It must not be taken for a constant
// pixel.
TEST(FilmError, IsUnknownIfSquaresExceedTheRange) {
  FilmSimulation simulation(40, 8);
  simulation.render([](auto, auto) { return 1.0; }, 4);
  EXPECT_TRUE(estimateError(simulation.film).known());
  FilmPlane& plane = simulation.film.planes[0];
  plane.squares[4 * 17] = fixedFromFloat(std::numeric_limits<float>::infinity());
  const ErrorEstimate estimate = estimateError(simulation.film);
  EXPECT_FALSE(estimate.known());
  EXPECT_FALSE(estimate.reaches(1e9));
  for (const std::uint32_t batches : planCells(estimate, {.error = 0, .batches = 8})) EXPECT_LE(batches, 16u);
  EXPECT_TRUE(std::isnan(varianceImage(simulation.film).pixel<float>(17, 0)[0]));
}

TEST(FilmError, IsUnknownIfAllPixelsAreNaN) {
  FilmSimulation simulation(40, 8);
  simulation.render([](auto, auto) { return std::numeric_limits<double>::quiet_NaN(); }, 4);
  EXPECT_FALSE(estimateError(simulation.film).known());
}

TEST(FilmError, IsZeroForConstantImages) {
  for (const double value : {0.0, 3.0}) {
    FilmSimulation simulation(40, 8);
    simulation.render([&](auto, auto) { return value; }, 4);
    EXPECT_LT(estimateError(simulation.film).upper, 1e-6);
  }
}

}  // namespace
}  // namespace quintet::render
