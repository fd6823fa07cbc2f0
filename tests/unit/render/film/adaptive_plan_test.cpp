// SPDX-License-Identifier: Apache-2.0
// The plan of adaptive sampling for films whose samples are known, and the cells of the next batch.
#include "render/film/adaptive_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

#include "film_simulation.h"

namespace quintet::render {
namespace {

// A sample of two tiles, one with much noise and one with little.
double twoTiles(std::mt19937& random, std::uint32_t x) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  return 1.0 + uniform(random) * (x < 32 ? 1.0 : 0.1);
}

TEST(PlanCells, AllocatesByStandardDeviation) {
  std::mt19937 random(2);
  const Draw draw = [&](std::uint32_t x, std::uint32_t) { return twoTiles(random, x); };
  FilmSimulation simulation(64, 32);
  simulation.render(draw, 8);
  const std::vector<std::uint32_t> plan = planCells(estimateError(simulation.film), {0, 44});
  ASSERT_EQ(plan.size(), 4u);
  EXPECT_NEAR(0.25 * (plan[0] + plan[1] + plan[2] + plan[3]), 44, 1.0) << "batches on average";
  EXPECT_NEAR(static_cast<double>(plan[0]) / plan[2], 10.0, 1.0) << "proportional to the standard deviation";
}

TEST(PlanCells, ReachesTheErrorWithoutExcess) {
  std::mt19937 random(3);
  const Draw draw = [&](std::uint32_t x, std::uint32_t) { return twoTiles(random, x); };
  FilmSimulation simulation(64, 32);
  simulation.render(draw, 8);
  const double goal = 0.03;
  const std::vector<std::uint32_t> plan = planCells(estimateError(simulation.film), {goal, 0});
  simulation.complete(draw, plan);
  const ErrorEstimate estimate = estimateError(simulation.film);
  EXPECT_LE(estimate.upper, 1.05 * goal);
  EXPECT_GT(estimate.upper, 0.6 * goal) << "not more than needed";
  EXPECT_GT(plan[0], 3 * plan[2]);
}

TEST(PlanCells, NeverRemovesBatches) {
  std::mt19937 random(4);
  FilmSimulation simulation(64, 32);
  simulation.render([&](std::uint32_t x, std::uint32_t) { return twoTiles(random, x); }, 8);
  for (const std::uint32_t batches : planCells(estimateError(simulation.film), {0.9, 0})) EXPECT_GE(batches, 8u);
  for (const std::uint32_t batches : planCells(estimateError(simulation.film), {0, 1})) EXPECT_GE(batches, 8u);
}

// If the target error is out of reach, the number of batches alone decides.
TEST(PlanCells, StaysWithinTheNumberOfBatches) {
  std::mt19937 random(6);
  FilmSimulation simulation(64, 32);
  simulation.render([&](std::uint32_t x, std::uint32_t) { return twoTiles(random, x); }, 8);
  const ErrorEstimate estimate = estimateError(simulation.film);
  EXPECT_EQ(planCells(estimate, {1e-5, 44}), planCells(estimate, {0, 44}));
  EXPECT_EQ(planCells(estimate, {0.03, 1e6}), planCells(estimate, {0.03, 0}));
}

// Rare bright samples: a pilot without any looks converged. A decision by a pixel's own samples would keep such dark
// means and average out the others. The samples of the other cell are independent of them.
double meanOfRuns(bool byOwnCell, double& standardError) {
  std::mt19937 random(5);
  const Draw draw = [&](auto, auto) { return random() % 16 == 0 ? 16.0 : 0.0; };
  double sum = 0, squares = 0;
  constexpr int kRuns = 20000;
  for (int run = 0; run < kRuns; ++run) {
    FilmSimulation simulation(2, 1);  // one pixel in each cell
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
  EXPECT_GT(std::abs(biased - 1.0), 6.0 * error) << "the test is sensitive to the bias of the wrong cells";
}

const Region kRegion{7, 3, shared::kTileSize + 5, 2 * shared::kTileSize};  // 2 x 2 tiles, 8 cells

TEST(AdaptiveBatch, StartsWithTheCommonBatches) {
  SampleCounts counts;
  counts.ranges = {{0, 2 * kBatchSamples}};
  const AdaptiveBatch next = nextAdaptiveBatch(kRegion, counts, {2, 2, 5, 2, 2, 2, 3, 9});
  EXPECT_EQ(next.batch, 2u);
  EXPECT_EQ(next.counts, (std::vector<std::uint32_t>{2, 2, 3, 2, 2, 2, 3, 3}));
  ASSERT_EQ(next.tiles.size(), 2u);
  EXPECT_EQ(next.tiles[0].x, shared::kTileSize);
  EXPECT_EQ(next.tiles[0].y, 0u);
  EXPECT_EQ(next.tiles[0].drawn[0], 1u);
  EXPECT_EQ(next.tiles[0].drawn[1], 0u);
  EXPECT_EQ(next.tiles[1].x, shared::kTileSize);
  EXPECT_EQ(next.tiles[1].y, shared::kTileSize);
  EXPECT_EQ(next.tiles[1].drawn[0], 1u);
  EXPECT_EQ(next.tiles[1].drawn[1], 1u);
}

TEST(AdaptiveBatch, SelectsTheCellsWithTheFewestBatches) {
  SampleCounts counts;
  counts.ranges = {{0, 2 * kBatchSamples}};
  counts.cellBatches = {4, 3, 2, 6, 5, 3, 3, 2};
  const AdaptiveBatch next = nextAdaptiveBatch(kRegion, counts, {9, 9, 2, 9, 9, 9, 9, 2});  // cells with 2 are complete
  EXPECT_EQ(next.batch, 3u);
  EXPECT_EQ(next.counts, (std::vector<std::uint32_t>{4, 4, 2, 6, 5, 4, 4, 2}));
  EXPECT_EQ(next.tiles.size(), 3u);
}

TEST(AdaptiveBatch, IsEmptyAtTheLimits) {
  SampleCounts counts;
  counts.cellBatches = std::vector<std::uint32_t>(8, 4);
  EXPECT_TRUE(nextAdaptiveBatch(kRegion, counts, std::vector<std::uint32_t>(8, 4)).tiles.empty());
}

}  // namespace
}  // namespace quintet::render
