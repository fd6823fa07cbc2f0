#include "schedule.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace quintet::app {
namespace {

// Batches of all pixels before the first decision of adaptive sampling: an eighth of the samples, within bounds.
constexpr std::uint64_t kFewestPilotBatches = 4;
constexpr std::uint64_t kMostPilotBatches = 16;

std::uint64_t pilotSamples(const RenderLimits& limits) {
  const std::uint64_t batches = limits.samples ? *limits.samples / (8 * render::kBatchSamples) : kMostPilotBatches / 2;
  return render::kBatchSamples * std::clamp(batches, kFewestPilotBatches, kMostPilotBatches);
}

}  // namespace

bool isLeft(const std::vector<std::uint32_t>& plan, const render::SampleCounts& counts) {
  for (std::uint32_t c = 0; c < plan.size(); ++c)
    if (plan[c] > counts.batchesOf(c)) return true;
  return false;
}

std::vector<std::uint32_t> decide(const render::Region& region, const render::SampleCounts& counts,
                                  const render::ErrorEstimate& estimate, const RenderLimits& limits) {
  const double samples = render::averageSamples(region, counts);
  const double most = static_cast<double>(limits.samples.value_or(0)) / render::kBatchSamples;
  if (limits.error && estimate.reaches(*limits.error)) return {};
  // Whole batches do not come nearer to the samples.
  if (limits.samples && samples > static_cast<double>(*limits.samples) - 0.5 * render::kBatchSamples) return {};
  render::CellGoal goal{limits.error.value_or(0), most};
  // Twice as many at most, until the time is over, or to an error: estimates of few samples say too little of what many need.
  const double twice = 2.0 * samples / render::kBatchSamples;
  if (!limits.samples || (limits.error && twice < most)) goal.batches = twice;
  std::vector<std::uint32_t> plan = render::planCells(estimate, goal);
  // The estimate thinks that this is enough, and it was not: a tenth more of everything.
  if (limits.error && !isLeft(plan, counts)) {
    for (std::uint32_t& batches : plan) batches += batches / 10 + (batches > 0 ? 1 : 0);
    const bool tooMany =
        limits.samples && render::averageSamples(region, {counts.ranges, plan}) > static_cast<double>(*limits.samples);
    if (tooMany) plan = render::planCells(estimate, {0, most});
  }
  if (!isLeft(plan, counts)) plan.clear();
  return plan;
}

bool isFinished(const render::FilmFile& film, const render::ErrorEstimate& estimate, const RenderLimits& limits) {
  const render::SampleCounts& counts = film.film.counts;
  if (limits.error && estimate.reaches(*limits.error)) return true;
  if (limits.samples && counts.samples() >= *limits.samples) return true;
  if (!limits.samples && !limits.error) return true;  // it had so much time
  if (counts.samples() < pilotSamples(limits) || isLeft(film.plan, counts)) return false;
  return decide(film.film.region, counts, estimate, limits).empty();
}

bool isHopeless(const render::ErrorEstimate& estimate, const RenderLimits& limits) {
  return limits.error && !limits.samples && !limits.seconds && !estimate.known();
}

bool looksAfter(std::uint64_t batches) {
  if (batches < 16) return batches >= 4;
  const int shift = static_cast<int>(std::bit_width(batches)) - 4;
  return (batches & ((std::uint64_t{1} << shift) - 1)) == 0;
}

Schedule::Schedule(render::Renderer& renderer, const RenderLimits& limits)
    : renderer_(renderer),
      limits_(limits),
      done_(limits.done),
      plan_(limits.plan),
      samples_(render::averageSamples(renderer.film().region(), renderer.film().counts())) {}

std::optional<std::uint64_t> Schedule::sampleLimit() const {
  return limits_.samples ? std::optional(*limits_.samples - limits_.begin) : std::nullopt;
}

void Schedule::look() {
  renderer_.finish();
  estimate_ = renderer_.film().estimateError();
}

bool Schedule::next() {
  if (limits_.adaptive && done_ >= pilotSamples(limits_)) return nextForCells();
  return nextForAll();
}

bool Schedule::nextForAll() {
  const bool complete = limits_.samples && done_ >= *limits_.samples;
  if (limits_.error && (complete || looksAfter(done_ / render::kBatchSamples))) {
    look();
    reached_ = estimate_->reaches(*limits_.error);
    if (isHopeless(*estimate_, limits_)) return false;
  }
  if (complete || reached_) return false;
  count_ = render::kBatchSamples;
  if (limits_.samples) count_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(count_, *limits_.samples - done_));
  step_ = count_;
  return true;
}

bool Schedule::nextForCells() {
  count_ = 0;
  step_ = 0;
  if (isLeft(plan_, renderer_.film().counts())) return true;
  look();
  reached_ = limits_.error && estimate_->reaches(*limits_.error);
  if (isHopeless(*estimate_, limits_)) return false;
  std::vector<std::uint32_t> plan = decide(renderer_.film().region(), renderer_.film().counts(), *estimate_, limits_);
  if (plan.empty()) return false;
  plan_ = std::move(plan);
  return true;
}

bool Schedule::render(const render::BatchProgress& progress) {
  if (count_ == 0) {
    if (!renderer_.renderCells(plan_, progress)) return false;
    samples_ = render::averageSamples(renderer_.film().region(), renderer_.film().counts());
    return true;
  }
  if (!renderer_.renderBatch(count_, progress)) return false;
  done_ += count_;
  samples_ = static_cast<double>(done_ - limits_.begin);
  return true;
}

}  // namespace quintet::app
