// SPDX-License-Identifier: Apache-2.0
// Finds fireflies: samples that alone make their pixel much brighter than its surroundings.
#ifndef QUINTET_JOB_BRIGHTEST_SAMPLES_H
#define QUINTET_JOB_BRIGHTEST_SAMPLES_H

#include <cstdint>
#include <span>
#include <vector>

#include "base/math.h"

namespace quintet::job {

struct Firefly {
  uvec2 pixel{0};  // of the region
  std::uint32_t sample = 0;
  float luminance = 0;  // of the sample
  float level = 0;      // typical luminance of the surroundings
  float ratio = 0;      // how much brighter than the level the sample alone makes the pixel: luminance / (N · level)
};

// Keeps the brightest sample of each pixel: 12 bytes per pixel.
class BrightestSamples {
 public:
  // Of a region with this size in pixels.
  explicit BrightestSamples(uvec2 size);

  // Adds a sample of every pixel, row by row. Samples that are not finite do not count.
  void add(std::uint32_t sample, std::span<const vec4> values);

  // Returns the pixels whose brightest sample alone makes them more than `threshold` times as bright as the level,
  // brightest ratio first. With m, the mean luminance of a pixel without its brightest sample, the level is the largest of:
  //  * the quantile 0.9 of m in the 7x7 pixels around the pixel, as far as they are in the region, so that edges of bright
  //    objects are none;
  //  * m of the pixel itself, so that small bright objects are none;
  //  * a hundredth of the mean of m in the region, so that light in a black region is none.
  // At least kMinSamples samples are needed; with fewer, there are none.
  std::vector<Firefly> find(float threshold) const;

  static constexpr std::uint32_t kMinSamples = 4;

 private:
  float othersMean(std::size_t pixel) const;
  float levelAround(std::uint32_t x, std::uint32_t y, const std::vector<float>& means) const;

  const uvec2 size_;
  std::uint32_t count_ = 0;           // of samples
  std::vector<float> sums_;           // of luminances, without the brightest sample
  std::vector<float> largest_;        // luminance
  std::vector<std::uint32_t> where_;  // the sample
};

}  // namespace quintet::job
#endif
