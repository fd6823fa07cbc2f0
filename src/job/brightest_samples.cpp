// SPDX-License-Identifier: Apache-2.0
#include "job/brightest_samples.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>

#include "base/luminance.h"

namespace quintet::job {
namespace {

constexpr std::int64_t kRadius = 3;
constexpr float kDarkest = 0.01f;  // of the mean of the region
constexpr double kQuantile = 0.9;  // of the surroundings

}  // namespace

BrightestSamples::BrightestSamples(uvec2 size)
    : size_(size), sums_(std::size_t{size.x} * size.y), largest_(sums_.size()), where_(sums_.size()) {}

void BrightestSamples::add(std::uint32_t sample, std::span<const vec4> values) {
  assert(values.size() == sums_.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float light = luminance(vec3(values[i]));
    if (!std::isfinite(light)) continue;
    if (light > largest_[i]) {
      sums_[i] += largest_[i];
      largest_[i] = light;
      where_[i] = sample;
    } else {
      sums_[i] += light;
    }
  }
  ++count_;
}

float BrightestSamples::othersMean(std::size_t pixel) const { return sums_[pixel] / static_cast<float>(count_ - 1); }

float BrightestSamples::levelAround(std::uint32_t x, std::uint32_t y, const std::vector<float>& means) const {
  std::array<float, (2 * kRadius + 1) * (2 * kRadius + 1)> around{};
  std::size_t count = 0;
  const auto range = [](std::uint32_t center, std::uint32_t size) {
    return std::pair(std::max<std::int64_t>(0, std::int64_t{center} - kRadius),
                     std::min<std::int64_t>(std::int64_t{size} - 1, std::int64_t{center} + kRadius));
  };
  const auto [left, right] = range(x, size_.x);
  const auto [top, bottom] = range(y, size_.y);
  for (std::int64_t row = top; row <= bottom; ++row)
    for (std::int64_t column = left; column <= right; ++column)
      around[count++] = means[static_cast<std::size_t>(row) * size_.x + static_cast<std::size_t>(column)];
  const auto at = around.begin() + static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(count));
  std::nth_element(around.begin(), at, around.begin() + static_cast<std::ptrdiff_t>(count));
  return *at;
}

std::vector<Firefly> BrightestSamples::find(float threshold) const {
  if (count_ < kMinSamples || sums_.empty()) return {};
  std::vector<float> means(sums_.size());
  double total = 0;
  for (std::size_t i = 0; i < means.size(); ++i) total += means[i] = othersMean(i);
  const auto darkest = static_cast<float>(kDarkest * total / static_cast<double>(means.size()));
  std::vector<Firefly> found;
  for (std::uint32_t y = 0; y < size_.y; ++y) {
    for (std::uint32_t x = 0; x < size_.x; ++x) {
      const std::size_t i = std::size_t{y} * size_.x + x;
      const float share = largest_[i] / static_cast<float>(count_);
      // The surroundings take time; most pixels need none.
      if (share <= threshold * std::max(means[i], darkest)) continue;
      const float level = std::max({levelAround(x, y, means), means[i], darkest});
      if (share > threshold * level) found.push_back({{x, y}, where_[i], largest_[i], level, share / level});
    }
  }
  std::ranges::stable_sort(found, std::greater(), &Firefly::ratio);
  return found;
}

}  // namespace quintet::job
