// SPDX-License-Identifier: Apache-2.0
#include "render/renderer/launch_sizes.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "render/film/film_state.h"

namespace quintet::render {
namespace {

// Pixels of the first launch. On a CPU, a sample of a heavy program takes a millisecond. A GPU needs many pixels to be busy.
constexpr double kFirstPixels = 16384, kFirstPixelsOfCpu = 512;
// Most pixels of a launch while the cost of some pixels is unknown, which are expected to be at most kUnknownFactor times as
// slow as the others.
constexpr double kUnknownPixels = 65536, kUnknownPixelsOfCpu = 8192;
constexpr double kUnknownFactor = 50;

}  // namespace

// Pixel samples of a launch that takes at most kLongestLaunch wherever it is in the known part of the film.
double LaunchSizes::safePixelSamples() const {
  const double slowest = std::max(slowest_, slowestBefore_);
  return slowest > 0 ? kLongestLaunch / slowest : std::numeric_limits<double>::infinity();
}

// The same for pixels of unknown cost.
double LaunchSizes::unknownPixels(double width) const {
  const double first = software_ ? kFirstPixelsOfCpu : std::max(kFirstPixels, kLaunchRows * width);
  if (slowest_ <= 0) return first;
  const double most = std::max(first, software_ ? kUnknownPixelsOfCpu : kUnknownPixels);
  return std::clamp(safePixelSamples() / kUnknownFactor, first, most);
}

std::uint32_t LaunchSizes::rows(double width, std::uint32_t row, std::uint32_t height, std::uint32_t samples) const {
  double pixels = safePixelSamples();
  if (!explored_) pixels = std::min(pixels, unknownPixels(width));
  if (rate_ > 0) pixels = std::min(pixels, launchSeconds_ * rate_ / (explored_ ? samples : 1));
  const double rows = std::clamp(pixels / width, 1.0, std::max(1.0, maxInvocations_ / width));
  return launchEnd(row, static_cast<std::uint32_t>(std::min<double>(rows, height)), height) - row;
}

bool LaunchSizes::isShort(double pixelSamples, bool launched) const {
  if (pixelSamples > 2.0 * launchSeconds_ * rate_) return false;
  return pixelSamples <= (launched ? kLongestLaunch * lastRate_ : safePixelSamples());
}

void LaunchSizes::add(double pixelSamples, double seconds) {
  const double duration = std::max(1e-6, seconds);
  lastRate_ = pixelSamples / duration;
  if (rate_ > 0) {
    slowest_ = std::max(slowest_, duration / pixelSamples);
    // Strips differ in cost: the rate rises slowly and falls immediately.
    rate_ = std::min(lastRate_, 2.0 * rate_);
  } else {
    rate_ = 0.25 * lastRate_;  // of the few pixels of the first launch
  }
}

void LaunchSizes::endPass(double pixels, double film) {
  pixelsSeen_ += pixels;
  if (pixelsSeen_ < film) return;
  pixelsSeen_ = 0;
  explored_ = true;
  slowestBefore_ = std::exchange(slowest_, 0.0);
}

}  // namespace quintet::render
