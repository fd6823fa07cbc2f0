// The stated error and the plan of adaptive sampling, by films whose samples are known.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "render/film_error.h"
#include "render/fixed_sum.h"

namespace quintet::render {
namespace {

using Draw = std::function<double(std::uint32_t x, std::uint32_t y)>;  // one sample of a grey pixel

struct Simulation {
  FilmState film;
  explicit Simulation(std::uint32_t width, std::uint32_t height) {
    film.region = {0, 0, width, height};
    const std::size_t pixels = film.pixelCount();
    film.planes = {{"color",
                    program::OutputPixel::mean,
                    std::vector<shared::FixedSum>(4 * pixels),
                    std::vector<shared::FixedSum>(4 * pixels),
                    {},
                    {}}};
  }
  void addBatch(const Draw& draw, std::uint32_t x, std::uint32_t y) {
    double sum = 0;
    for (std::uint32_t s = 0; s < kBatchSamples; ++s) sum += draw(x, y);
    const auto value = static_cast<float>(sum);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t i = 4 * (std::size_t{y} * film.region.width + x) + c;
      film.planes[0].sums[i] = addFixed(film.planes[0].sums[i], fixedFromFloat(value));
      film.planes[0].squares[i] = addFixed(film.planes[0].squares[i], fixedFromFloat(value * value / kBatchSamples));
    }
  }
  void render(const Draw& draw, std::uint32_t batches) {
    for (std::uint32_t y = 0; y < film.region.height; ++y)
      for (std::uint32_t x = 0; x < film.region.width; ++x)
        for (std::uint32_t b = 0; b < batches; ++b) addBatch(draw, x, y);
    film.counts.add({0, batches * kBatchSamples});
  }
  void complete(const Draw& draw, const std::vector<std::uint32_t>& plan) {
    for (std::uint32_t y = 0; y < film.region.height; ++y)
      for (std::uint32_t x = 0; x < film.region.width; ++x) {
        const std::uint32_t cell = film.cellOf(x, y);
        for (std::uint64_t b = film.counts.batchesOf(cell); b < plan[cell]; ++b) addBatch(draw, x, y);
      }
    film.counts.cellBatches = plan;
  }
};

TEST(FilmError, IsThatOfKnownSamples) {
  // Uniform in [0,2]: mean 1, variance 1/3; of 64 samples 1/192. Relative to Y² + (0.1 · mean)² = 1.01.
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 2);
  Simulation simulation(64, 48);
  simulation.render([&](auto, auto) { return uniform(random); }, 16);
  const ErrorEstimate estimate = estimateError(simulation.film);
  const double exact = std::sqrt(1.0 / 192 / 1.01);
  // At most a pixel's own luminance is what its error is relative to: a little more than the exact one.
  EXPECT_GT(estimate.image, 0.99 * exact);
  EXPECT_LT(estimate.image, (1.0 + exact) * exact);
  EXPECT_GT(estimate.upper, estimate.image);
  EXPECT_LT(estimate.upper, 1.1 * exact);
  EXPECT_NEAR(estimate.tiles, exact, 0.1 * exact);
  EXPECT_TRUE(estimate.reaches(1.1 * exact));
  EXPECT_FALSE(estimate.reaches(0.9 * exact));
}

TEST(FilmError, IsNotKnownBelowTwoBatches) {
  Simulation simulation(8, 8);
  simulation.render([](auto, auto) { return 1.0; }, 1);
  EXPECT_TRUE(std::isinf(estimateError(simulation.film).upper));
}

// Read in strips of tile rows, adaptive counts or not: the same words in any order.
TEST(FilmError, OfStripsIsThatOfTheWhole) {
  std::mt19937 random(8);
  const Draw draw = [&](std::uint32_t x, std::uint32_t) {
    return 1.0 + 0.01 * static_cast<double>(random() % 100) * (x < 32 ? 1.0 : 0.1);
  };
  for (const bool adaptive : {false, true}) {
    Simulation simulation(70, 75);
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

// Noise in one pixel, or in a few batches: what is stated must leave the room that so few numbers ask for.
TEST(FilmError, CoversPicturesOfFewNoisyPixels) {
  std::mt19937 random(6);
  std::normal_distribution<double> normal(1.0, 0.2);
  for (const std::uint32_t noisy : {1u, 40u})
    for (const std::uint32_t batches : {2u, 4u, 16u}) {
      int covered = 0;
      constexpr int kRuns = 200;
      for (int run = 0; run < kRuns; ++run) {
        Simulation simulation(8, 5);
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
      // 95 %, less three standard deviations of 200 runs; and not by saying nothing.
      EXPECT_GE(covered, 181) << noisy << " pixels, " << batches << " batches";
      if (noisy == 40 && batches == 16) {
        EXPECT_LT(covered, 200);
      }
    }
}

// A pixel of the sun in cd/m²: its squares are beyond the film's range, which must not pass for a constant pixel.
TEST(FilmError, IsNotKnownWhereSquaresAreBeyondTheRange) {
  Simulation simulation(40, 8);
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

TEST(FilmError, BlackAndConstantPicturesHaveNone) {
  for (const double value : {0.0, 3.0}) {
    Simulation simulation(40, 8);
    simulation.render([&](auto, auto) { return value; }, 4);
    EXPECT_LT(estimateError(simulation.film).upper, 1e-6);
  }
}

// One tile is noisy, the other hardly.
double twoTiles(std::mt19937& random, std::uint32_t x) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  return 1.0 + uniform(random) * (x < 32 ? 1.0 : 0.1);
}

TEST(PlanCells, SpendsWhereTheSpreadIs) {
  std::mt19937 random(2);
  const Draw draw = [&](std::uint32_t x, std::uint32_t) { return twoTiles(random, x); };
  Simulation simulation(64, 32);
  simulation.render(draw, 8);
  const std::vector<std::uint32_t> plan = planCells(estimateError(simulation.film), {0, 44});
  ASSERT_EQ(plan.size(), 4u);
  EXPECT_NEAR(0.25 * (plan[0] + plan[1] + plan[2] + plan[3]), 44, 1.0) << "batches on average";
  EXPECT_NEAR(static_cast<double>(plan[0]) / plan[2], 10.0, 1.0) << "in proportion to the standard deviation";
}

TEST(PlanCells, ReachesTheErrorWithFewerSamples) {
  std::mt19937 random(3);
  const Draw draw = [&](std::uint32_t x, std::uint32_t) { return twoTiles(random, x); };
  Simulation simulation(64, 32);
  simulation.render(draw, 8);
  const double goal = 0.03;
  const std::vector<std::uint32_t> plan = planCells(estimateError(simulation.film), {goal, 0});
  simulation.complete(draw, plan);
  const ErrorEstimate estimate = estimateError(simulation.film);
  EXPECT_LE(estimate.upper, 1.05 * goal);
  EXPECT_GT(estimate.upper, 0.6 * goal) << "not more than needed";
  EXPECT_GT(plan[0], 3 * plan[2]);
}

TEST(PlanCells, NeverGoesBelowWhatIsThere) {
  std::mt19937 random(4);
  Simulation simulation(64, 32);
  simulation.render([&](std::uint32_t x, std::uint32_t) { return twoTiles(random, x); }, 8);
  for (const std::uint32_t batches : planCells(estimateError(simulation.film), {0.9, 0})) EXPECT_GE(batches, 8u);
  for (const std::uint32_t batches : planCells(estimateError(simulation.film), {0, 1})) EXPECT_GE(batches, 8u);
}

// An error out of reach: then it is as if only the number had been given.
TEST(PlanCells, AnErrorDoesNotLeadBeyondTheBatches) {
  std::mt19937 random(6);
  Simulation simulation(64, 32);
  simulation.render([&](std::uint32_t x, std::uint32_t) { return twoTiles(random, x); }, 8);
  const ErrorEstimate estimate = estimateError(simulation.film);
  EXPECT_EQ(planCells(estimate, {1e-5, 44}), planCells(estimate, {0, 44}));
  EXPECT_EQ(planCells(estimate, {0.03, 1e6}), planCells(estimate, {0.03, 0}));
}

// Rare bright samples: a pilot that met none looks converged. Deciding by a pixel's own samples keeps such lucky (dark)
// means as they are and thins out the others; the other cell's say nothing about them.
double meanOfRuns(bool byOwnCell, double& standardError) {
  std::mt19937 random(5);
  const Draw draw = [&](auto, auto) { return random() % 16 == 0 ? 16.0 : 0.0; };
  double sum = 0, squares = 0;
  constexpr int kRuns = 20000;
  for (int run = 0; run < kRuns; ++run) {
    Simulation simulation(2, 1);  // one pixel in each cell
    simulation.render(draw, 4);
    ErrorEstimate estimate = estimateError(simulation.film);
    if (byOwnCell) std::swap(estimate.cells[0], estimate.cells[1]);
    simulation.complete(draw, planCells(estimate, {0, 12}));
    const io::Image image = planeImage(simulation.film, 0);
    const double mean = 0.5 * (image.pixel<float>(0, 0)[0] + image.pixel<float>(1, 0)[0]);
    sum += mean / kRuns;
    squares += mean * mean / kRuns;
  }
  standardError = std::sqrt((squares - sum * sum) / kRuns);
  return sum;
}

TEST(PlanCells, DoesNotBiasTheMean) {
  double error = 0;
  const double mean = meanOfRuns(false, error);
  EXPECT_NEAR(mean, 1.0, 3.5 * error);
  const double biased = meanOfRuns(true, error);
  EXPECT_GT(std::abs(biased - 1.0), 6.0 * error) << "this test sees the bias of the other way";
}

}  // namespace
}  // namespace quintet::render
