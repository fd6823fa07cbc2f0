// Batch after batch until the samples are there, the time is over, or somebody presses Ctrl-C.
#ifndef QUINTET_APP_RENDER_LOOP_H
#define QUINTET_APP_RENDER_LOOP_H

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "progress.h"
#include "schedule.h"
#include "signals.h"

namespace quintet::app {

struct RenderOutcome {
  bool interrupted = false;              // by a signal, before the limits: something is missing
  bool abandoned = false;                // RenderHooks::abandon said so
  std::optional<std::uint32_t> frame;    // of an animation: the one rendered last
  std::uint64_t samples = 0;             // per pixel that are there now
  double seconds = 0;                    // wall clock of all batches
  double batchSeconds = 0;               // of the last one
  bool missed = false;                   // the error that was asked for is not reached
  double firstPixelSeconds = 0;          // from the start of the loop until the first launch is done
  std::vector<std::uint32_t> plan = {};  // Schedule::plan()
};

// What --watch and checkpoints add; each may be empty.
struct RenderHooks {
  std::function<bool()> abandon;                         // asked between launches: give up, the picture is of no use
  std::function<void(const RenderOutcome&)> firstBatch;  // the first batch is complete
  std::function<void(const RenderOutcome&)> afterBatch = {};  // any batch is complete
  bool states = false;                                        // the progress line tells the error
};

// At least one batch is rendered, unless all is done already. A batch is begun only if at least half of it is likely to fit into
// the time that is left.
RenderOutcome renderBatches(render::Renderer& renderer, const RenderLimits& limits, const GracefulStop& stop,
                            Progress& progress, const RenderHooks& hooks = {});

}  // namespace quintet::app
#endif
