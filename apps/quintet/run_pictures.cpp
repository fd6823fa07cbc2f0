#include "run_pictures.h"

#include <algorithm>

#include "base/error.h"

namespace quintet::app {
namespace {

constexpr double kRefreshSeconds = 1.0;  // with --watch, the picture of a long run of frames is written so often

bool accumulates(const Session& session) { return session.program().accumulation == program::Accumulation::program; }

RenderOutcome renderFilm(Session& session, const RenderOptions& options, const GracefulStop& stop,
                         const RenderHooks& hooks) {
  return renderBatches(session.renderer(), {options.samples, options.seconds, options.error, options.adaptive}, stop,
                       session.progress(), hooks);
}

// With --watch the first batch is shown at once, and the picture again when it is complete.
PictureEnd drawFilm(Session& session, const RenderOptions& options, const GracefulStop& stop,
                    const PictureHooks& hooks) {
  RenderHooks inner;
  inner.abandon = hooks.abandon;
  if (hooks.firstPicture) {
    inner.firstBatch = [&](const RenderOutcome& outcome) {
      session.write(outcome);
      hooks.firstPicture(session.written());
    };
  }
  const RenderOutcome outcome = renderFilm(session, options, stop, inner);
  if (outcome.abandoned) return PictureEnd::abandoned;
  session.write(outcome);
  return outcome.interrupted ? PictureEnd::interrupted : PictureEnd::complete;
}

// Each frame is a picture of its own; where only the last one is written, only that one is rendered.
PictureEnd drawMovingScene(Session& session, const RunOptions& options, const GracefulStop& stop,
                           const PictureHooks& hooks) {
  const std::uint32_t count = *options.render.frames;
  double seconds = 0, firstPixelSeconds = 0;
  for (std::uint32_t frame = options.allFrames ? 0 : count - 1; frame < count; ++frame) {
    session.beginFrame(frame);
    RenderOutcome outcome = renderFilm(session, options.render, stop, {hooks.abandon, {}, {}, false});
    if (outcome.abandoned) return PictureEnd::abandoned;
    if (firstPixelSeconds == 0) firstPixelSeconds = outcome.firstPixelSeconds;
    seconds += outcome.seconds;
    outcome.seconds = seconds;
    outcome.firstPixelSeconds = firstPixelSeconds;
    outcome.frame = frame;
    outcome.interrupted = outcome.interrupted || (stop.requested() && frame + 1 < count);
    session.write(outcome, options.allFrames ? std::optional(frame) : std::nullopt);
    if (hooks.firstPicture) hooks.firstPicture(session.written());
    if (outcome.interrupted) return PictureEnd::interrupted;
  }
  return PictureEnd::complete;
}

// A program that accumulates: one launch of the picture per frame.
class FrameLoop {
 public:
  FrameLoop(Session& session, const RunOptions& options, const GracefulStop& stop, const PictureHooks& hooks)
      : session_(session), options_(options), stop_(stop), hooks_(hooks) {
    state_.unit = "frames";
    state_.sampleLimit = options.render.drawnFrames;
    state_.secondLimit = options.render.seconds;
  }

  PictureEnd run() {
    for (std::uint32_t frame = 0;; ++frame) {
      if (!render(frame)) return PictureEnd::abandoned;
      const bool last = isLast(frame);
      outcome_.interrupted = stop_.requested() && !last;
      if (last || outcome_.interrupted || options_.allFrames || wantsRefresh()) write(frame);
      if (outcome_.interrupted) return PictureEnd::interrupted;
      if (last) return PictureEnd::complete;
    }
  }

 private:
  bool render(std::uint32_t frame) {
    session_.beginFrame(frame);
    bool abandoned = false;
    session_.renderer().renderFrame(frame, [&](double fraction) {
      if (outcome_.firstPixelSeconds == 0) outcome_.firstPixelSeconds = clock_.seconds();
      state_.samples = frame + fraction;
      state_.seconds = clock_.seconds();
      session_.progress().update(state_);
      abandoned = hooks_.abandon && hooks_.abandon();
      return !abandoned;
    });
    outcome_.seconds = clock_.seconds();
    outcome_.frame = frame;
    return !abandoned;
  }

  bool isLast(std::uint32_t frame) const {
    const RenderOptions& render = options_.render;
    return (render.drawnFrames && frame + 1 >= *render.drawnFrames) ||
           (render.seconds && clock_.seconds() >= *render.seconds);
  }

  bool wantsRefresh() const {
    return hooks_.firstPicture && (!written_ || clock_.seconds() - lastWritten_ >= kRefreshSeconds);
  }

  void write(std::uint32_t frame) {
    session_.write(outcome_, options_.allFrames ? std::optional(frame) : std::nullopt);
    lastWritten_ = clock_.seconds();
    if (!written_ && hooks_.firstPicture) hooks_.firstPicture(session_.written());
    written_ = true;
  }

  Session& session_;
  const RunOptions& options_;
  const GracefulStop& stop_;
  const PictureHooks& hooks_;
  const Stopwatch clock_;
  ProgressState state_;
  RenderOutcome outcome_;
  bool written_ = false;
  double lastWritten_ = 0;
};

}  // namespace

PictureEnd drawPictures(Session& session, const RunOptions& options, const GracefulStop& stop,
                        const PictureHooks& hooks) {
  if (accumulates(session)) return FrameLoop(session, options, stop, hooks).run();
  const bool several = options.render.frames.value_or(1) > 1;
  if (several && !session.animated())
    throw UsageError(
        "--frames: the program averages its samples itself and nothing in the scene moves: all frames would be the "
        "same");
  if (several || (options.allFrames && session.animated())) {
    RunOptions frames = options;
    frames.render.frames = options.render.frames.value_or(1);
    return drawMovingScene(session, frames, stop, hooks);
  }
  return drawFilm(session, options.render, stop, hooks);
}

}  // namespace quintet::app
