// SPDX-License-Identifier: Apache-2.0
#include "job/sampling_schedule.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace quintet::job {
namespace {

// Uniform batches before the first decision of adaptive sampling: an eighth of the samples, within bounds.
constexpr std::uint64_t kMinPilotBatches = 4;
constexpr std::uint64_t kMaxPilotBatches = 16;

std::uint64_t pilotSamples(const RenderLimits& limits) {
  const std::uint64_t batches = limits.samples ? *limits.samples / (8 * render::kBatchSamples) : kMaxPilotBatches / 2;
  return render::kBatchSamples * std::clamp(batches, kMinPilotBatches, kMaxPilotBatches);
}

}  // namespace

bool hasRemainingBatches(const std::vector<std::uint32_t>& plan, const render::SampleCounts& counts) {
  for (std::uint32_t c = 0; c < plan.size(); ++c)
    if (plan[c] > counts.batchesOf(c)) return true;
  return false;
}

std::vector<std::uint32_t> planNextBatches(const render::Region& region, const render::SampleCounts& counts,
                                           const render::ErrorEstimate& estimate, const RenderLimits& limits) {
  const double samples = render::averageSamples(region, counts);
  const double limit = static_cast<double>(limits.samples.value_or(0)) / render::kBatchSamples;
  if (limits.error && estimate.reaches(*limits.error)) return {};
  // Whole batches do not come closer to the limit.
  if (limits.samples && samples > static_cast<double>(*limits.samples) - 0.5 * render::kBatchSamples) return {};
  render::CellGoal goal{limits.error.value_or(0), limit};
  // At most twice the samples at a time for a time limit or a target error: estimates from few samples say too little
  // about how many are needed.
  const double twice = 2.0 * samples / render::kBatchSamples;
  if (!limits.samples || (limits.error && twice < limit)) goal.batches = twice;
  std::vector<std::uint32_t> plan = render::planCells(estimate, goal);
  // By the estimate this is enough, but the target was not reached: add a tenth everywhere.
  if (limits.error && !hasRemainingBatches(plan, counts)) {
    for (std::uint32_t& batches : plan) batches += batches / 10 + (batches > 0 ? 1 : 0);
    const bool tooMany =
        limits.samples && render::averageSamples(region, {counts.ranges, plan}) > static_cast<double>(*limits.samples);
    if (tooMany) plan = render::planCells(estimate, {0, limit});
  }
  if (!hasRemainingBatches(plan, counts)) plan.clear();
  return plan;
}

bool isComplete(const render::FilmState& film, const std::vector<std::uint32_t>& plan,
                const render::ErrorEstimate& estimate, const RenderLimits& limits) {
  const render::SampleCounts& counts = film.counts;
  if (limits.error && estimate.reaches(*limits.error)) return true;
  if (limits.samples && counts.samples() >= *limits.samples) return true;
  if (!limits.samples && !limits.error) return true;  // limited by time only
  if (counts.samples() < pilotSamples(limits) || hasRemainingBatches(plan, counts)) return false;
  return planNextBatches(film.region, counts, estimate, limits).empty();
}

std::optional<double> expectedSamples(const render::ErrorEstimate& estimate, double target, double samples) {
  if (!estimate.known() || !std::isfinite(estimate.tiles)) return std::nullopt;
  const double ratio = std::max(estimate.upper, 0.5 * estimate.tiles) / target;  // ErrorEstimate::reaches
  return samples * ratio * ratio;
}

bool targetUnreachable(const render::ErrorEstimate& estimate, const RenderLimits& limits) {
  return limits.error && !limits.samples && !limits.seconds && !estimate.known();
}

bool isErrorCheckpoint(std::uint64_t batches) {
  if (batches < 16) return batches >= 4;
  const int shift = static_cast<int>(std::bit_width(batches)) - 4;
  return (batches & ((std::uint64_t{1} << shift) - 1)) == 0;
}

SamplingSchedule::SamplingSchedule(DeviceTeam& team, const RenderLimits& limits, const StartPoint& start)
    : team_(team),
      limits_(limits),
      start_(start),
      done_(start.done),
      plan_(start.plan),
      samples_(render::averageSamples(team.region(), team.counts())) {}

std::optional<std::uint64_t> SamplingSchedule::sampleLimit() const {
  return limits_.samples ? std::optional(std::max(*limits_.samples, start_.begin) - start_.begin) : std::nullopt;
}

void SamplingSchedule::estimateError() {
  estimate_ = team_.estimateError();
  estimatedAt_ = samples_;
}

std::optional<double> SamplingSchedule::targetSamples() const {
  if (!limits_.error || !estimate_) return std::nullopt;
  return expectedSamples(*estimate_, *limits_.error, estimatedAt_);
}

bool SamplingSchedule::next(double seconds) {
  seconds_ = seconds;
  if (limits_.adaptive && done_ >= pilotSamples(limits_)) return nextAdaptiveBatches();
  return nextUniformBatches();
}

bool SamplingSchedule::stopsAtError() {
  estimateError();
  const bool isReached = limits_.error && estimate_->reaches(*limits_.error);
  if (isReached) reached_ = ReachedLimit::error;
  if (targetUnreachable(*estimate_, limits_)) reached_ = ReachedLimit::unknownError;
  return isReached || reached_ == ReachedLimit::unknownError;
}

std::uint64_t SamplingSchedule::batchesToDecision() const {
  std::uint64_t count = std::numeric_limits<std::uint32_t>::max();
  const std::uint64_t done = done_ / render::kBatchSamples;
  if (limits_.adaptive) count = (pilotSamples(limits_) - done_ + render::kBatchSamples - 1) / render::kBatchSamples;
  if (!limits_.error) return count;
  std::uint64_t next = done + 1;
  while (!isErrorCheckpoint(next)) ++next;
  return std::min(count, next - done);
}

bool SamplingSchedule::nextUniformBatches() {
  const bool complete = limits_.samples && done_ >= *limits_.samples;
  if (limits_.error && (complete || isErrorCheckpoint(done_ / render::kBatchSamples)) && stopsAtError()) return false;
  if (complete) return false;
  count_ = render::kBatchSamples * std::min(team_.batchesWithin(seconds_), batchesToDecision());
  if (limits_.samples) count_ = std::min(count_, *limits_.samples - done_);
  batchSamples_ = static_cast<double>(count_);
  return true;
}

bool SamplingSchedule::nextAdaptiveBatches() {
  count_ = 0;
  batchSamples_ = 0;
  if (hasRemainingBatches(plan_, team_.counts())) return true;
  if (stopsAtError()) return false;
  std::vector<std::uint32_t> plan = planNextBatches(team_.region(), team_.counts(), *estimate_, limits_);
  if (plan.empty()) return false;
  plan_ = std::move(plan);
  return true;
}

bool SamplingSchedule::render(const render::BatchProgress& progress) {
  if (count_ == 0) {
    if (!team_.renderCells(plan_, seconds_, progress)) return false;
    samples_ = render::averageSamples(team_.region(), team_.counts());
    return true;
  }
  if (!team_.renderSamples(count_, progress)) return false;
  done_ += count_;
  samples_ = static_cast<double>(done_ - start_.begin);
  return true;
}

}  // namespace quintet::job
