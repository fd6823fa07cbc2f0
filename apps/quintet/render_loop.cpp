#include "render_loop.h"

namespace quintet::app {
namespace {

constexpr double kCountSeconds = 1.0;  // reading the ray counter waits for the device: not more often
constexpr double kLookSeconds = 2.0;   // so does the error
constexpr double kLookShare = 50.0;

}  // namespace

RenderOutcome renderBatches(render::Renderer& renderer, const RenderLimits& limits, const GracefulStop& stop,
                            Progress& progress, const RenderHooks& hooks) {
  RenderOutcome outcome;
  const Stopwatch clock;
  Schedule schedule(renderer, limits);
  ProgressState state;
  state.sampleLimit = schedule.sampleLimit();
  state.secondLimit = limits.seconds;
  outcome.samples = static_cast<std::uint64_t>(schedule.samples());
  outcome.seconds = limits.secondsBefore;
  outcome.batchSeconds = limits.batchSecondsBefore;
  outcome.plan = schedule.plan();
  const auto isOver = [&](double seconds, double batch) {
    return limits.seconds && seconds + 0.5 * batch >= *limits.seconds;
  };
  if (limits.done > limits.begin && isOver(limits.secondsBefore, limits.batchSecondsBefore)) {
    outcome.missed = limits.error && !renderer.film().estimateError().reaches(*limits.error);
    return outcome;
  }
  double counted = 0, looked = 0, lookSeconds = 0;
  bool told = false, first = limits.done == 0;
  while (schedule.next()) {
    const double begin = limits.secondsBefore + clock.seconds();
    const double before = schedule.samples();
    const bool whole = schedule.render([&](double fraction) {
      if (outcome.firstPixelSeconds == 0) outcome.firstPixelSeconds = clock.seconds();
      if (stop.requested() && !told) {
        progress.note("interrupted: finishing the batch; once more leaves at once, without a picture");
        told = true;
      }
      state.samples = before + fraction * schedule.step();
      state.seconds = limits.secondsBefore + clock.seconds();
      if (schedule.estimate()) state.error = schedule.estimate()->upper;
      progress.update(state);
      outcome.abandoned = hooks.abandon && hooks.abandon();
      return !outcome.abandoned;
    });
    if (!whole || outcome.abandoned) return outcome;  // a batch of one launch is whole when it hears of that
    const double now = limits.secondsBefore + clock.seconds();
    if (outcome.firstPixelSeconds == 0) outcome.firstPixelSeconds = clock.seconds();
    outcome.seconds = now;
    outcome.batchSeconds = now - begin;
    outcome.samples = static_cast<std::uint64_t>(schedule.samples());
    outcome.plan = schedule.plan();
    if (first && hooks.firstBatch) hooks.firstBatch(outcome);
    first = false;
    if (hooks.afterBatch) hooks.afterBatch(outcome);
    if (isOver(now, now - begin)) break;
    if (stop.requested()) {
      outcome.interrupted = schedule.next();  // else all is there
      break;
    }
    if (now - counted > kCountSeconds) {
      state.raysPerSecond = static_cast<double>(renderer.rays().rays) / now;
      counted = now;
    }
    // The estimate for the progress line takes at most a fiftieth of the time.
    if (hooks.states && !limits.error && now - looked > kLookSeconds + kLookShare * lookSeconds) {
      schedule.look();
      looked = limits.secondsBefore + clock.seconds();
      lookSeconds = looked - now;
    }
  }
  renderer.finish();
  outcome.seconds = limits.secondsBefore + clock.seconds();
  outcome.missed = limits.error && !schedule.reached();
  return outcome;
}

}  // namespace quintet::app
