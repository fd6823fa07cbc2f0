// SPDX-License-Identifier: Apache-2.0
// The launches of a renderer in flight. It limits how many wait on the device, and measures each launch once it has finished,
// which decides the sizes of the next ones (launch_sizes.h).
#ifndef QUINTET_RENDER_RENDERER_LAUNCH_QUEUE_H
#define QUINTET_RENDER_RENDERER_LAUNCH_QUEUE_H

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "base/stopwatch.h"
#include "gpu/timer.h"
#include "render/renderer/launch_sizes.h"
#include "render/renderer/render_settings.h"

namespace quintet::render {

struct RenderStatistics {
  double compileSeconds = 0;      // GLSL to SPIR-V
  double pipelineSeconds = 0;     // SPIR-V to pipeline
  double firstLaunchSeconds = 0;  // wall clock of the first launch, and of the driver's compilation before it
  double renderSeconds = 0;       // wall clock of all batches
  double deviceSeconds = 0;       // device time of all finished launches
  std::uint64_t samples = 0;      // per pixel; number of frames for a program that accumulates
  std::uint64_t batches = 0;
};

// Measurements of one launch. Times are seconds on the device unless stated otherwise.
struct LaunchTiming {
  std::uint32_t rows = 0;
  std::uint32_t samples = 0;  // per pixel
  double beginSeconds = 0;    // clearing the batch
  double traceSeconds = 0;
  double endSeconds = 0;   // adding the batch to the total
  double idleSeconds = 0;  // idle time since the previous launch; 0 for the first launch
  double wallSeconds = 0;  // wall clock from the start of recording to the end of the wait
};

class LaunchQueue {
 public:
  // Uses launchSeconds, timeoutSeconds, launchesInFlight and profile of settings from decideSettings(). Updates
  // firstLaunchSeconds and deviceSeconds of `statistics`, which must outlive the queue.
  LaunchQueue(gpu::Context& context, const RenderSettings& settings, RenderStatistics& statistics);

  // The sizes of the next launches, as the finished ones show them.
  LaunchSizes& sizes() { return sizes_; }

  using Record = std::function<void(gpu::Commands&)>;
  // Before the first launch, on devices whose drivers compile in it: a trace without rays. The limit of launches does not
  // apply, because the time depends on the driver and on other processes, not on what the shaders do.
  void compile(const Record& trace);

  struct Launch {
    std::uint32_t rows = 0;
    std::uint32_t samples = 0;  // per pixel
    double pixelSamples = 0;
    const Record& before;  // can be empty
    const Record& trace;
    const Record& after;  // can be empty
  };
  // Submits a launch, after waiting for the oldest one if too many are in flight.
  void submit(const Launch& launch);
  // Waits for all launches. Throws TimeoutError.
  void finish();

  // Returns the finished launches of a profiled renderer.
  const std::vector<LaunchTiming>& timings() const { return timings_; }

 private:
  struct InFlight {
    std::uint64_t value = 0;  // of the timeline semaphore
    Stopwatch sinceRecording;
    gpu::Timer* timer = nullptr;
    std::uint64_t number = 0;  // from 1
    std::uint32_t rows = 0;
    std::uint32_t samples = 0;
    double pixelSamples = 0;
  };

  void finishOldest();
  void recordTiming(const InFlight& launch, double wallSeconds);

  gpu::Context& context_;
  RenderStatistics& statistics_;
  const double timeoutSeconds_;
  const std::uint32_t maxInFlight_;
  const bool profile_;
  LaunchSizes sizes_;
  std::array<gpu::Timer, kMaxLaunchesInFlight> timers_;  // used in turn
  std::deque<InFlight> inFlight_;                        // oldest first
  std::uint64_t count_ = 0;
  std::vector<LaunchTiming> timings_;
  double lastStamp_ = 0;       // device time at which the previous launch ended
  double compileSeconds_ = 0;  // of compile()
};

}  // namespace quintet::render
#endif
