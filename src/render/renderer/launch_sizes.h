// SPDX-License-Identifier: Apache-2.0
// How many rows and samples a launch has, so that it takes about the requested time and can be waited for: a launch cannot be
// canceled. Without Vulkan.
#ifndef QUINTET_RENDER_RENDERER_LAUNCH_SIZES_H
#define QUINTET_RENDER_RENDERER_LAUNCH_SIZES_H

#include <cstdint>

namespace quintet::render {

// No launch should take longer than this, in seconds.
inline constexpr double kLongestLaunch = 1.0;

class LaunchSizes {
 public:
  // `software`: the device is a CPU. `maxInvocations`: of a launch. `launchSeconds`: RenderSettings.
  LaunchSizes(bool software, double maxInvocations, double launchSeconds)
      : software_(software), maxInvocations_(maxInvocations), launchSeconds_(launchSeconds) {}

  // Returns the number of rows of the next launch, which begins at `row` of `height`, so that `samples` samples of each
  // pixel take about launchSeconds, and one sample takes at most about kLongestLaunch also where pixels are the slowest. The
  // launch ends at `height` or at a multiple of kLaunchRows, unless it is shorter than that.
  std::uint32_t rows(double width, std::uint32_t row, std::uint32_t height, std::uint32_t samples) const;
  // Returns whether so many samples are known to take at most about twice launchSeconds, and at most kLongestLaunch if all of
  // them are as slow as the slowest ones. `launched`: one sample of these pixels was the last launch.
  bool isShort(double pixelSamples, bool launched = false) const;

  // A launch has ended.
  void add(double pixelSamples, double seconds);
  // All of so many pixels have been launched. `film`: pixels of the film.
  void endPass(double pixels, double film);
  // The film was not rendered once, so the cost of some pixels is unknown: a launch then has few pixels, and first one sample.
  bool exploring() const { return !explored_; }

 private:
  double safePixelSamples() const;
  double unknownPixels(double width) const;

  bool software_;
  double maxInvocations_, launchSeconds_;
  double rate_ = 0;      // pixel samples per second; 0 while unknown
  double lastRate_ = 0;  // of the last launch
  // Seconds per pixel sample of the slowest launch of this pass over the film, and of the pass before: the time of a launch
  // depends on what else the machine does, so older values do not count.
  double slowest_ = 0, slowestBefore_ = 0;
  double pixelsSeen_ = 0;  // in this pass
  bool explored_ = false;
};

}  // namespace quintet::render
#endif
