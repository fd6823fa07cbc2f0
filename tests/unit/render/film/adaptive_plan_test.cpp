// SPDX-License-Identifier: Apache-2.0
// The plan of adaptive sampling for films whose samples are known, and the order of their batches.
#include "render/film/adaptive_plan.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

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

// A film of tiles with these variances of one batch, after 8 batches, in both cells.
ErrorEstimate estimateOf(const std::vector<double>& variances, std::uint64_t batches = 8) {
  ErrorEstimate estimate;
  for (const double variance : variances)
    for (int cell = 0; cell < 2; ++cell) {
      const double ofMean = variance / static_cast<double>(batches);
      estimate.cells.push_back({512, batches, 512 * ofMean, 512 * ofMean * ofMean});
    }
  return estimate;
}

// A tile without visible noise gets batches as if it had a hundredth of the mean variance: with variances 1 and 0 the mean is 0.5,
// so the numbers are in the ratio 1 to √0.005.
TEST(PlanCells, GivesAHundredthOfTheMeanVarianceToTilesWithoutNoise) {
  const std::vector<std::uint32_t> plan = planCells(estimateOf({1.0, 0.0}), {0, 1000});
  const double least = std::sqrt(0.005), factor = 2000.0 / (1.0 + least);
  ASSERT_EQ(plan.size(), 4u);
  for (const std::size_t cell : {0u, 1u}) EXPECT_NEAR(plan[cell], factor, 2.0);
  for (const std::size_t cell : {2u, 3u}) EXPECT_NEAR(plan[cell], factor * least, 2.0);
  // One with little noise above that limit gets its own share.
  const std::vector<std::uint32_t> own = planCells(estimateOf({1.0, 0.01}), {0, 1000});
  EXPECT_NEAR(own[0], 2000.0 / 1.1, 2.0);
  EXPECT_NEAR(own[2], 200.0 / 1.1, 2.0);
}

// Each cell reaches half of its tile's allowed margin: batches ≥ margin² · variance / (2 · target)².
TEST(PlanCells, LimitsTheErrorOfEachTile) {
  std::vector<double> variances(64, 1e-6);
  variances[5] = 40.0;
  const ErrorEstimate estimate = estimateOf(variances);
  ErrorSums sums;
  sums.add(estimate.cells[10]);
  const std::vector<std::uint32_t> plan = planCells(estimate, {0.5, 0});
  EXPECT_GE(plan[10], sums.marginSquared() * 40.0 / (4.0 * 0.25));
  EXPECT_LE(plan[10], std::ceil(sums.marginSquared() * 40.0 / (4.0 * 0.25)) + 1);
  EXPECT_EQ(plan[0], 8u) << "has enough";
}

TEST(PlanCells, HasAtMostTwoToThe22Batches) {
  const std::vector<std::uint32_t> plan = planCells(estimateOf({1.0, 1.0}), {1e-6, 0});
  for (const std::uint32_t batches : plan) EXPECT_EQ(batches, 1u << 22);
  // More than that are not taken away.
  EXPECT_EQ(planCells(estimateOf({1.0}, (1u << 22) + 5u), {1e-6, 0})[0], (1u << 22) + 5u);
}

// A cell without pixels, in a tile of one column, gets nothing; the other one decides for itself.
TEST(PlanCells, HasNoBatchesForCellsWithoutPixels) {
  ErrorEstimate estimate = estimateOf({1.0, 1.0});
  estimate.cells[3] = {0, 8, 0, 0};
  const std::vector<std::uint32_t> plan = planCells(estimate, {0, 100});
  EXPECT_EQ(plan[3], 0u);
  EXPECT_NEAR(plan[2], 100, 1.0);
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

const Region kRegion{7, 3, 2 * shared::kTileSize - 5, 2 * shared::kTileSize};  // 2 x 2 tiles, 8 cells

using Limits = std::vector<std::uint32_t>;

// "x y batch cells", for each tile.
std::vector<std::string> describe(const AdaptiveBatches& batches) {
  std::vector<std::string> tiles;
  for (const shared::FilmTile& tile : batches.tiles)
    tiles.push_back(fmt::format("{} {} {} {}", tile.x / shared::kTileSize, tile.y / shared::kTileSize, tile.batch,
                                tile.drawn[0] != 0u ? (tile.drawn[1] != 0u ? "both" : "even") : "odd"));
  return tiles;
}

// As many as the film has tiles.
TEST(AdaptiveBatches, FollowTheCommonBatches) {
  SampleCounts counts;
  counts.ranges = {{0, 2 * kBatchSamples}};
  const Limits limits{2, 2, 5, 2, 2, 2, 3, 9};
  const AdaptiveBatches next = nextAdaptiveBatches(kRegion, counts, limits);
  EXPECT_EQ(next.counts, (Limits{2, 2, 4, 2, 2, 2, 3, 4}));
  EXPECT_EQ(describe(next), (std::vector<std::string>{"1 0 2 even", "1 1 2 both", "1 0 3 even", "1 1 3 odd"}));
}

TEST(AdaptiveBatches, BeginWithTheCellsThatHaveTheFewest) {
  SampleCounts counts;
  counts.ranges = {{0, 2 * kBatchSamples}};
  counts.cellBatches = {4, 3, 2, 6, 5, 3, 4, 2};
  const Limits limits{9, 9, 2, 9, 9, 9, 9, 2};  // cells with 2 are complete
  const AdaptiveBatches one = nextAdaptiveBatches(kRegion, counts, limits, true);
  EXPECT_EQ(one.counts, (Limits{4, 4, 2, 6, 5, 4, 4, 2}));
  EXPECT_EQ(describe(one), (std::vector<std::string>{"0 0 3 odd", "0 1 3 odd"}));
  const AdaptiveBatches all = nextAdaptiveBatches(kRegion, counts, limits);
  EXPECT_EQ(all.counts, (Limits{5, 5, 2, 6, 5, 5, 4, 2}));
  EXPECT_EQ(describe(all), (std::vector<std::string>{"0 0 3 odd", "0 1 3 odd", "0 0 4 both", "0 1 4 odd"}));
}

// Every cell gets each batch up to its limit once, in order, and no launch has more tiles than the film.
TEST(AdaptiveBatches, FillTheFilm) {
  const Region region{0, 0, 100, 70};  // 4 x 3 tiles
  const Limits limits{1, 3, 2, 1, 4, 40, 1, 1, 3, 3, 2, 5, 7, 7, 9, 2, 1, 4, 4, 4, 3, 2, 6, 1};
  for (const bool one : {false, true}) {
    SampleCounts counts;
    counts.ranges = {{0, kBatchSamples}};
    Limits reached(limits.size(), 1);
    std::uint32_t launches = 0;
    for (;; ++launches) {
      const AdaptiveBatches next = nextAdaptiveBatches(region, counts, limits, one);
      if (next.tiles.empty()) break;
      ASSERT_LE(next.tiles.size(), 12u);
      for (std::size_t first = 0; first < next.tiles.size(); first = endOfBatch(next.tiles, first)) {
        if (first > 0) {
          EXPECT_FALSE(one);
          EXPECT_GT(next.tiles[first].batch, next.tiles[first - 1].batch);
        }
        std::set<std::uint32_t> tiles;
        for (std::size_t i = first; i < endOfBatch(next.tiles, first); ++i) {
          const std::uint32_t tile = next.tiles[i].y / shared::kTileSize * 4 + next.tiles[i].x / shared::kTileSize;
          EXPECT_TRUE(tiles.insert(tile).second) << "twice in one batch";
          for (std::uint32_t c = 0; c < 2; ++c) {
            if (next.tiles[i].drawn[c] == 0u) continue;
            EXPECT_EQ(next.tiles[i].batch, reached[2 * tile + c]++);
          }
        }
      }
      EXPECT_EQ(next.counts, reached);
      counts.cellBatches = next.counts;
    }
    EXPECT_EQ(reached, limits);
    EXPECT_EQ(launches, one ? 39u : 7u) << "39 batches, 73 tiles";
  }
}

TEST(AdaptiveBatches, AreEmptyAtTheLimits) {
  SampleCounts counts;
  counts.cellBatches = Limits(8, 4);
  EXPECT_TRUE(nextAdaptiveBatches(kRegion, counts, Limits(8, 4)).tiles.empty());
}

}  // namespace
}  // namespace quintet::render
