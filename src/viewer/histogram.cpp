// SPDX-License-Identifier: Apache-2.0
#include "viewer/histogram.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <mutex>

#include "base/luminance.h"
#include "base/parallel.h"

namespace quintet::viewer {
namespace {

std::size_t binOf(float value) {
  if (!(value > 0.0f)) return 0;
  const double bin = (std::log2(value) - Histogram::kFirstStop) / Histogram::kStopsPerBin;
  return static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(kHistogramBins - 1)));
}

struct Partial {
  Histogram histogram;
  double sum = 0;
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
  std::uint64_t pixels = 0;

  void addPixel(const float* rgba) {
    if (!std::isfinite(rgba[0]) || !std::isfinite(rgba[1]) || !std::isfinite(rgba[2])) {
      ++histogram.notFinitePixels;
      return;
    }
    for (std::size_t c = 0; c < 3; ++c) ++histogram.channels[c][binOf(rgba[c])];
    const float light = luminance({rgba[0], rgba[1], rgba[2]});
    ++histogram.luminance[binOf(light)];
    least = std::min<double>(least, light);
    most = std::max<double>(most, light);
    sum += light;
    ++pixels;
  }

  void add(const Partial& other) {
    for (std::size_t i = 0; i < kHistogramBins; ++i) {
      for (std::size_t c = 0; c < 3; ++c) histogram.channels[c][i] += other.histogram.channels[c][i];
      histogram.luminance[i] += other.histogram.luminance[i];
    }
    histogram.notFinitePixels += other.histogram.notFinitePixels;
    least = std::min(least, other.least);
    most = std::max(most, other.most);
    sum += other.sum;
    pixels += other.pixels;
  }
};

}  // namespace

Histogram makeHistogram(const io::Image& image) {
  assert(image.channels == 4 && image.type == io::PixelType::f32);
  const float* samples = image.samples<float>().data();
  Partial total;
  std::mutex mutex;
  parallelRanges(image.pixelCount(), [&](std::size_t first, std::size_t last) {
    Partial part;
    for (std::size_t i = first; i < last; ++i) part.addPixel(samples + 4 * i);
    const std::lock_guard lock(mutex);
    total.add(part);
  });
  Histogram result = total.histogram;
  if (total.pixels > 0) {
    result.least = total.least;
    result.most = total.most;
    result.mean = total.sum / static_cast<double>(total.pixels);
  }
  return result;
}

}  // namespace quintet::viewer
