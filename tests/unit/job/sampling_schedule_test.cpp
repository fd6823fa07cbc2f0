// SPDX-License-Identifier: Apache-2.0
// Adaptive sampling: plans stay within the limits, end at them, and depend on the film alone.
#include "job/sampling_schedule.h"

#include <gmock/gmock.h>

namespace quintet::job {
namespace {

constexpr render::Region kRegion{0, 0, 64, 32};  // two tiles, four cells

// All pixels have `batches`.
render::FilmFile filmOf(std::uint32_t batches) {
  render::FilmFile film;
  film.film.region = kRegion;
  film.film.counts.ranges = {{0, batches * render::kBatchSamples}};
  return film;
}
// The second tile is `ratio` times as noisy as the first one.
render::ErrorEstimate estimateOf(const render::FilmFile& film, double error, double ratio) {
  render::ErrorEstimate estimate;
  estimate.image = estimate.upper = estimate.tiles = error;
  const double quiet = error * error / (0.5 * (1.0 + ratio * ratio));
  for (std::uint32_t c = 0; c < 4; ++c) {
    const double square = quiet * (c < 2 ? 1.0 : ratio * ratio);
    estimate.cells.push_back({512, film.film.counts.batchesOf(c), 512 * square, 512 * square * square});
  }
  return estimate;
}
RenderLimits limitsOf(std::optional<std::uint64_t> samples, std::optional<double> error) {
  return {samples, {}, error, true};
}

std::vector<std::uint32_t> planFor(const render::FilmFile& film, const render::ErrorEstimate& estimate,
                                   const RenderLimits& limits) {
  return planNextBatches(film.film.region, film.film.counts, estimate, limits);
}

TEST(PlanNextBatches, DistributesTheRemainingSamples) {
  const render::FilmFile film = filmOf(8);
  const std::vector<std::uint32_t> plan = planFor(film, estimateOf(film, 0.1, 3.0), limitsOf(160, {}));
  ASSERT_EQ(plan.size(), 4u);
  EXPECT_NEAR(plan[0], 20, 1);  // 40 batches on average, three times as many in the second tile
  EXPECT_NEAR(plan[2], 60, 1);
  EXPECT_LE(render::averageSamples(kRegion, {film.film.counts.ranges, plan}), 160.0);
}

// One more batch in the noisy tile gives 34 samples on average. That is the limit, or closer to it than 32 samples are.
TEST(PlanNextBatches, AddsABatchThatComesCloserToTheLimit) {
  const render::FilmFile film = filmOf(8);
  for (const std::uint64_t limit : {34u, 35u})
    EXPECT_THAT(planFor(film, estimateOf(film, 0.1, 3.0), limitsOf(limit, {})), testing::ElementsAre(8, 8, 9, 9))
        << limit;
}

TEST(PlanNextBatches, IsEmptyAtTheLimit) {
  const render::FilmFile film = filmOf(8);
  const render::ErrorEstimate estimate = estimateOf(film, 0.1, 3.0);
  EXPECT_TRUE(planFor(film, estimate, limitsOf(32, {})).empty());
  EXPECT_TRUE(planFor(film, estimate, limitsOf(33, {})).empty()) << "another batch would not come closer";
  EXPECT_FALSE(planFor(film, estimate, limitsOf(48, {})).empty());
  EXPECT_TRUE(planFor(film, estimate, limitsOf({}, 0.1)).empty());
  EXPECT_TRUE(planFor(film, estimate, limitsOf(4000, 0.1)).empty());
  EXPECT_FALSE(planFor(film, estimate, limitsOf({}, 0.099)).empty());
}

// (4/3)² times the batches for three quarters of the error: 14.2; times the margin for 95 % confidence, from the 1,024 pixels
// of the other cells with 7 degrees of freedom each: F(1024, 7168) = 1.077.
TEST(PlanNextBatches, PlansForTheTargetError) {
  const render::FilmFile film = filmOf(8);
  const std::vector<std::uint32_t> plan = planFor(film, estimateOf(film, 0.1, 1.0), limitsOf({}, 0.075));
  ASSERT_EQ(plan.size(), 4u);
  for (const std::uint32_t batches : plan) EXPECT_NEAR(batches, 14.22 * 1.077, 0.7);
  EXPECT_EQ(planFor(film, estimateOf(film, 0.1, 1.0), limitsOf(1'000'000, 0.075)), plan)
      << "a distant sample limit changes nothing";
}

// Estimates from a few batches are unreliable for a distant target: at most twice the samples, distributed by the noise.
TEST(PlanNextBatches, PlansAtMostTwiceTheSamples) {
  const render::FilmFile film = filmOf(8);
  const render::ErrorEstimate estimate = estimateOf(film, 0.1, 3.0);
  const std::vector<std::uint32_t> plan = planFor(film, estimate, limitsOf({}, 0.01));
  ASSERT_EQ(plan.size(), 4u);
  EXPECT_NEAR(render::averageSamples(kRegion, {film.film.counts.ranges, plan}), 64.0, 2.0);
  EXPECT_NEAR(static_cast<double>(plan[2]) / plan[0], 3.0, 0.2);
  EXPECT_EQ(planFor(film, estimate, limitsOf(1'000'000, 0.01)), plan) << "a distant sample limit changes nothing";
  EXPECT_EQ(planFor(film, estimate, limitsOf(48, 0.001)), planFor(film, estimate, limitsOf(48, {})));
}

TEST(TargetUnreachable, IfTheErrorIsUnknownAndTheOnlyLimit) {
  const render::ErrorEstimate known = estimateOf(filmOf(8), 0.1, 1.0), unknown;
  EXPECT_TRUE(targetUnreachable(unknown, limitsOf({}, 0.01)));
  EXPECT_FALSE(targetUnreachable(unknown, limitsOf(64, 0.01))) << "the number of samples is limited";
  EXPECT_FALSE(targetUnreachable(unknown, limitsOf({}, {}))) << "no target";
  EXPECT_FALSE(targetUnreachable(known, limitsOf({}, 0.01)));
}

// The mean error reaches the target, but that of the tiles does not: planCells adds nothing, so a tenth is added, within the
// sample limit.
TEST(PlanNextBatches, AddsATenthIfTheTargetIsMissedAgainstTheEstimate) {
  const render::FilmFile film = filmOf(40);
  render::ErrorEstimate estimate = estimateOf(film, 0.1, 1.0);
  estimate.tiles = 1.0;
  EXPECT_EQ(planFor(film, estimate, limitsOf({}, 0.2)), std::vector<std::uint32_t>(4, 45));
  const std::vector<std::uint32_t> capped = planFor(film, estimate, limitsOf(168, 0.2));
  ASSERT_EQ(capped.size(), 4u);
  EXPECT_LE(render::averageSamples(kRegion, {film.film.counts.ranges, capped}), 168.0);
  EXPECT_TRUE(planFor(film, estimate, limitsOf(160, 0.2)).empty());
}

TEST(PlanNextBatches, DoublesWithoutOtherLimits) {
  const render::FilmFile film = filmOf(8);
  for (const std::uint32_t batches : planFor(film, estimateOf(film, 0.1, 1.0), limitsOf({}, {})))
    EXPECT_NEAR(batches, 16, 1);
}

TEST(IsComplete, WhereARenderWouldStop) {
  render::FilmFile film = filmOf(3);
  const auto complete = [&](const RenderLimits& limits) {
    return isComplete(film.film, film.plan, estimateOf(film, 0.1, 3.0), limits);
  };
  EXPECT_FALSE(complete(limitsOf(40, {}))) << "the first batches of all pixels";
  EXPECT_TRUE(complete(limitsOf(12, {})));
  EXPECT_TRUE(complete(limitsOf({}, 0.1)));
  EXPECT_TRUE(complete(limitsOf({}, {}))) << "only its time was limited";
  film = filmOf(8);
  film.film.counts.cellBatches = {8, 8, 12, 12};
  EXPECT_TRUE(complete(limitsOf(40, {})));
  EXPECT_FALSE(complete(limitsOf(64, {})));
  film.plan = {8, 8, 12, 13};
  EXPECT_FALSE(complete(limitsOf(40, {}))) << "the plan has remaining batches";
  EXPECT_TRUE(hasRemainingBatches(film.plan, film.film.counts));
  film.plan = {8, 8, 12, 1};
  EXPECT_FALSE(hasRemainingBatches(film.plan, film.film.counts));
}

TEST(IsErrorCheckpoint, EightTimesPerDoubling) {
  std::vector<std::uint64_t> checkpoints;
  for (std::uint64_t batches = 0; batches <= 64; ++batches)
    if (isErrorCheckpoint(batches)) checkpoints.push_back(batches);
  EXPECT_THAT(checkpoints, testing::ElementsAre(4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 18, 20, 22, 24, 26, 28,
                                                30, 32, 36, 40, 44, 48, 52, 56, 60, 64));
}

TEST(ExpectedSamples, GrowWithTheSquareOfTheErrorRatio) {
  render::ErrorEstimate estimate;
  EXPECT_FALSE(expectedSamples(estimate, 0.1, 16));  // unknown
  estimate.upper = 0.2;
  estimate.tiles = 0.3;
  EXPECT_DOUBLE_EQ(expectedSamples(estimate, 0.1, 16).value(), 64.0);
  estimate.tiles = 0.6;  // at most twice the target
  EXPECT_DOUBLE_EQ(expectedSamples(estimate, 0.1, 16).value(), 144.0);
}

}  // namespace
}  // namespace quintet::job
