// What a long rendering leaves on the disk while it goes on, and how it goes on from there; and parts of renderings.
#ifndef QUINTET_APP_CHECKPOINT_H
#define QUINTET_APP_CHECKPOINT_H

#include <cstdint>

#include "progress.h"
#include "render/film_file.h"
#include "render_loop.h"
#include "render_options.h"
#include "session.h"

namespace quintet::app {

// Of one `render`, whose program is linked and has rendered nothing yet.
class Checkpoint {
 public:
  Checkpoint(Session& session, const RenderOptions& options);

  // Restores the renderer, if asked for and possible, and says what is left to do. Throws FileError where something
  // would be lost, or the checkpoint is of another rendering.
  RenderLimits begin();

  // After each batch: writes the checkpoint when its time has come, and the line of --json-progress.
  void afterBatch(const RenderOutcome& outcome);
  // At the end of rendering, before the picture is written: the checkpoint is complete if somebody wants it.
  void afterRendering(const RenderOutcome& outcome);
  // All samples of the outcome are on the disk after it, if that is possible: the picture could not be written.
  void keep(const RenderOutcome& outcome);
  // The picture is there.
  void afterPicture(const RenderOutcome& outcome);

 private:
  bool active() const { return options_.farm.checkpointSeconds.has_value(); }
  void resume(RenderLimits& limits);
  void checkPlace(const render::FilmFile& file, const RenderLimits& limits) const;
  void save(const RenderOutcome& outcome);
  void warn(const std::string& text);  // once
  void goOn(const render::FilmFile& file, RenderLimits& limits);
  bool isKept(const RenderOutcome& outcome) const;

  Session& session_;
  const RenderOptions& options_;
  const Stopwatch clock_;
  double lastWritten_ = 0;          // on clock_
  std::uint64_t savedSamples_ = 0;  // in the checkpoint on the disk
  render::SampleCounts savedCounts_;
  bool warned_ = false;
};

}  // namespace quintet::app
#endif
