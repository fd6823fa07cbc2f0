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

bool looksAfter(std::uint64_t batches) {
  if (batches < 16) return batches >= 4;
  const int shift = static_cast<int>(std::bit_width(batches)) - 4;
  return (batches & ((std::uint64_t{1} << shift) - 1)) == 0;
}

Schedule::Schedule(render::Renderer& renderer, const RenderLimits& limits)
    : renderer_(renderer), limits_(limits), done_(limits.done), samples_(static_cast<double>(limits.done - limits.begin)) {}

std::optional<std::uint64_t> Schedule::sampleLimit() const {
  return limits_.samples ? std::optional(*limits_.samples - limits_.begin) : std::nullopt;
}

void Schedule::look() {
  renderer_.finish();
  estimate_ = render::estimateError(renderer_.film().saveFirst());
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
  }
  if (complete || reached_) return false;
  count_ = render::kBatchSamples;
  if (limits_.samples) count_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(count_, *limits_.samples - done_));
  step_ = count_;
  return true;
}

double Schedule::average() const {
  double sum = 0, pixels = 0;
  const render::SampleCounts& counts = renderer_.film().counts();
  for (std::size_t c = 0; c < estimate_->cells.size(); ++c) {
    pixels += estimate_->cells[c].pixels;
    sum += static_cast<double>(estimate_->cells[c].pixels) * static_cast<double>(counts.samplesOf(static_cast<std::uint32_t>(c)));
  }
  return sum / pixels;
}

bool Schedule::nextForCells() {
  count_ = 0;
  const render::SampleCounts& counts = renderer_.film().counts();
  const auto wants = [&](std::size_t c) { return plan_[c] > counts.batchesOf(static_cast<std::uint32_t>(c)); };
  const auto anyLeft = [&] {
    for (std::size_t c = 0; c < plan_.size(); ++c)
      if (wants(c)) return true;
    return false;
  };
  if (!anyLeft() && (!planNext() || !anyLeft())) return false;
  samples_ = average();
  step_ = 0;
  return true;
}

// Decides how many batches each cell shall have next; false: it is enough.
bool Schedule::planNext() {
  look();
  samples_ = average();
  reached_ = limits_.error && estimate_->reaches(*limits_.error);
  const double budget = limits_.samples ? static_cast<double>(*limits_.samples) : 0;
  if (reached_ || (budget > 0 && samples_ > budget - 0.5 * render::kBatchSamples)) return false;
  render::CellGoal goal;
  goal.batches = budget / render::kBatchSamples;
  if (limits_.error) goal.error = *limits_.error;
  else if (budget == 0) goal.batches = 2.0 * samples_ / render::kBatchSamples;  // until the time is over
  std::vector<std::uint32_t> plan = render::planCells(*estimate_, goal);
  const bool grows = plan_.empty() || plan != plan_;
  plan_ = std::move(plan);
  // The estimate thinks that this is enough, and it was not: a tenth more of everything.
  if (!grows && limits_.error)
    for (std::uint32_t& batches : plan_) batches += batches / 10 + (batches > 0 ? 1 : 0);
  return true;
}

bool Schedule::render(const render::BatchProgress& progress) {
  if (count_ == 0) {
    const bool whole = renderer_.renderCells(plan_, progress);
    if (whole && estimate_) samples_ = average();
    return whole;
  }
  if (!renderer_.renderBatch(count_, progress)) return false;
  done_ += count_;
  samples_ = static_cast<double>(done_ - limits_.begin);
  return true;
}

}  // namespace quintet::app
