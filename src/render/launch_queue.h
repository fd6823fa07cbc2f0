// The launches of a renderer on their way: as many on the device as may wait there, each so large that it takes about the
// wanted time, and what is known of each once it has ended.
#ifndef QUINTET_RENDER_LAUNCH_QUEUE_H
#define QUINTET_RENDER_LAUNCH_QUEUE_H

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "base/stopwatch.h"
#include "gpu/timer.h"
#include "render/renderer.h"

namespace quintet::render {

class LaunchQueue {
 public:
  static constexpr std::uint32_t kMost = 2;  // launches under way; there are as many timers

  // Takes launchSeconds, timeoutSeconds, launchesInFlight (at most kMost) and profile of the settings, once they are
  // decided. Adds to firstLaunchSeconds and deviceSeconds of `statistics`, which outlives it.
  LaunchQueue(gpu::Context& context, const RenderSettings& settings, RenderStatistics& statistics);

  // Rows of the next launch, so that `samples` samples of each pixel take about launchSeconds. What is
  // chosen changes nothing in the image.
  std::uint32_t rows(double width, std::uint32_t rowsLeft, std::uint32_t samples) const;
  // Whether so many samples are known to take at most about twice that.
  bool isShort(double pixelSamples) const;

  using Record = std::function<void(gpu::Commands&)>;
  struct Launch {
    std::uint32_t rows = 0;
    std::uint32_t samples = 0;  // per pixel
    double pixelSamples = 0;
    const Record& before;  // may be empty
    const Record& trace;
    const Record& after;  // may be empty
  };
  // Waits for the oldest launch if there are too many.
  void submit(const Launch& launch);
  void finish();

  // Of the launches that have ended, of a profiled renderer.
  const std::vector<LaunchTiming>& timings() const { return timings_; }

 private:
  // A launch that the device has not been seen to end.
  struct InFlight {
    std::uint64_t value = 0;  // of the timeline
    Stopwatch sinceRecording;
    gpu::Timer* timer = nullptr;
    std::uint32_t rows = 0;
    std::uint32_t samples = 0;
    double pixelSamples = 0;
  };

  void finishOldest();
  void note(const InFlight& launch, double wall);

  gpu::Context& context_;
  RenderStatistics& statistics_;
  const double launchSeconds_, timeoutSeconds_;
  const std::uint32_t most_;
  const bool profile_;
  std::array<gpu::Timer, kMost> timers_;  // in turns
  std::deque<InFlight> inFlight_;         // oldest first
  std::uint64_t count_ = 0;
  std::vector<LaunchTiming> timings_;
  double lastStamp_ = 0;              // of the device, when the launch before ended
  double pixelSamplesPerSecond_ = 0;  // measured; 0: unknown yet
};

}  // namespace quintet::render
#endif
