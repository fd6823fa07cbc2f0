// SPDX-License-Identifier: Apache-2.0
#include "scene/animation/interpolate.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

namespace quintet::scene {
namespace {

// The interval that contains a time.
struct Interval {
  std::size_t first = 0;  // index of its beginning in AnimationSampler::times
  double fraction = 0;    // [0, 1); 0 before the first and after the last time
  double length = 0;      // seconds
};

Interval intervalAt(const AnimationSampler& sampler, double seconds) {
  // Times are floats: a frame number divided by the rate must be able to meet one.
  const auto time = static_cast<float>(seconds);
  const auto next = std::ranges::upper_bound(sampler.times, time);
  if (next == sampler.times.begin()) return {};
  const auto first = static_cast<std::size_t>(next - sampler.times.begin()) - 1;
  if (next == sampler.times.end()) return {first, 0.0, 0.0};
  const double length = double{*next} - double{sampler.times[first]};
  return {first, (double{time} - double{sampler.times[first]}) / length, length};
}

// Parts of a key of a cubic spline; the other interpolations only have the value.
enum class KeyPart { inTangent, value, outTangent };

const float* valueOf(const AnimationSampler& sampler, std::size_t key, KeyPart part = KeyPart::value) {
  const bool cubic = sampler.interpolation == Interpolation::cubicSpline;
  const std::size_t index = cubic ? 3 * key + static_cast<std::size_t>(part) : key;
  return sampler.values.data() + index * sampler.valueSize;
}

glm::dquat normalized(const glm::dquat& q) {
  const double length = glm::length(q);
  return std::isfinite(length) && length > 0.0 ? q / length : glm::dquat(1, 0, 0, 0);
}

glm::dquat quaternionOf(const float* v) { return normalized(glm::dquat(v[3], v[0], v[1], v[2])); }

}  // namespace

void interpolate(const AnimationSampler& sampler, double seconds, std::span<float> out) {
  assert(out.size() == sampler.valueSize);
  const Interval interval = intervalAt(sampler, seconds);
  const float* const a = valueOf(sampler, interval.first);
  if (interval.fraction == 0.0 || sampler.interpolation == Interpolation::step) {
    std::copy_n(a, out.size(), out.begin());
    return;
  }
  const double t = interval.fraction;
  const float* const b = valueOf(sampler, interval.first + 1);
  if (sampler.interpolation == Interpolation::linear) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<float>((1.0 - t) * a[i] + t * b[i]);
    return;
  }
  const float* const leaving = valueOf(sampler, interval.first, KeyPart::outTangent);
  const float* const arriving = valueOf(sampler, interval.first + 1, KeyPart::inTangent);
  const double t2 = t * t, t3 = t2 * t;
  constexpr double kLargest = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double value = (2.0 * t3 - 3.0 * t2 + 1.0) * a[i] + interval.length * (t3 - 2.0 * t2 + t) * leaving[i] +
                         (3.0 * t2 - 2.0 * t3) * b[i] + interval.length * (t3 - t2) * arriving[i];
    out[i] = static_cast<float>(std::clamp(value, -kLargest, kLargest));
  }
}

glm::dquat interpolateRotation(const AnimationSampler& sampler, double seconds) {
  assert(sampler.valueSize == 4);
  if (sampler.interpolation == Interpolation::linear) {
    const Interval interval = intervalAt(sampler, seconds);
    const glm::dquat a = quaternionOf(valueOf(sampler, interval.first));
    if (interval.fraction == 0.0) return a;
    return normalized(glm::slerp(a, quaternionOf(valueOf(sampler, interval.first + 1)), interval.fraction));
  }
  std::array<float, 4> value{};
  interpolate(sampler, seconds, value);
  return quaternionOf(value.data());
}

}  // namespace quintet::scene
