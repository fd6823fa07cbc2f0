#include "run_pictures.h"

namespace quintet::app {
namespace {

// With --watch the first batch is shown at once, and the picture again when it is complete.
PictureEnd drawFilm(Session& session, const RenderOptions& options, const GracefulStop& stop, const PictureHooks& hooks) {
  RenderHooks inner;
  inner.abandon = hooks.abandon;
  if (hooks.firstPicture) {
    inner.firstBatch = [&](const RenderOutcome& outcome) {
      session.write(outcome);
      hooks.firstPicture(session.written());
    };
  }
  const RenderOutcome outcome =
      renderBatches(session.renderer(), {options.samples, options.seconds}, stop, session.progress(), inner);
  if (outcome.abandoned) return PictureEnd::abandoned;
  session.write(outcome);
  return outcome.interrupted ? PictureEnd::interrupted : PictureEnd::complete;
}

}  // namespace

PictureEnd drawPictures(Session& session, const RunOptions& options, const GracefulStop& stop, const PictureHooks& hooks) {
  return drawFilm(session, options.render, stop, hooks);
}

}  // namespace quintet::app
