#include "render_loop.h"

#include <algorithm>

namespace quintet::app {
namespace {

constexpr double kCountSeconds = 1.0;  // reading the ray counter waits for the device: not more often

}  // namespace

RenderOutcome renderBatches(render::Renderer& renderer, const RenderLimits& limits, const GracefulStop& stop,
                            Progress& progress, const RenderHooks& hooks) {
  RenderOutcome outcome;
  const Stopwatch clock;
  ProgressState state;
  if (limits.samples) state.sampleLimit = *limits.samples - limits.begin;
  state.secondLimit = limits.seconds;
  std::uint64_t done = limits.done;
  outcome.samples = done - limits.begin;
  outcome.seconds = limits.secondsBefore;
  const bool complete = limits.samples && done >= *limits.samples;
  const bool late = limits.seconds && done > limits.begin && limits.secondsBefore >= *limits.seconds;
  if (complete || late) return outcome;
  double counted = 0;
  bool told = false;
  while (true) {
    std::uint32_t count = render::kBatchSamples;
    if (limits.samples)
      count = static_cast<std::uint32_t>(std::min<std::uint64_t>(count, *limits.samples - done));
    const double begin = limits.secondsBefore + clock.seconds();
    renderer.renderBatch(count, [&](double fraction) {
      if (outcome.firstPixelSeconds == 0) outcome.firstPixelSeconds = clock.seconds();
      if (stop.requested() && !told) {
        progress.note("interrupted: finishing the batch; once more leaves at once, without a picture");
        told = true;
      }
      state.samples = static_cast<double>(done - limits.begin) + fraction * count;
      state.seconds = limits.secondsBefore + clock.seconds();
      progress.update(state);
      outcome.abandoned = hooks.abandon && hooks.abandon();
      return !outcome.abandoned;
    });
    if (outcome.abandoned) return outcome;
    done += count;
    const double now = limits.secondsBefore + clock.seconds();
    if (outcome.firstPixelSeconds == 0) outcome.firstPixelSeconds = clock.seconds();
    outcome.seconds = now;
    outcome.samples = done - limits.begin;
    if (done == count && hooks.firstBatch) hooks.firstBatch(outcome);
    if (hooks.afterBatch) hooks.afterBatch(outcome);
    if (stop.requested()) {
      outcome.interrupted = !limits.samples || done < *limits.samples;
      break;
    }
    if (limits.samples && done >= *limits.samples) break;
    if (limits.seconds && now + 0.5 * (now - begin) >= *limits.seconds) break;
    if (now - counted > kCountSeconds) {
      state.raysPerSecond = static_cast<double>(renderer.rays().rays) / now;
      counted = now;
    }
  }
  return outcome;
}

}  // namespace quintet::app
