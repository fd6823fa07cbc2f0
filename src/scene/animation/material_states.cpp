// SPDX-License-Identifier: Apache-2.0
#include "scene/animation/material_states.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "scene/animation/interpolate.h"
#include "scene/animation/pose.h"
#include "scene/model/surface_class.h"

namespace quintet::scene {
namespace {

// The values at which a feature can begin or end.
const std::array kThresholds{0.0, std::sqrt(double{kPaneAlpha}), 1.0};

vec4 valueAt(const AnimationSampler& sampler, double seconds) {
  vec4 value(0.0f);
  interpolate(sampler, seconds, {&value.x, sampler.valueSize});
  return value;
}

double componentAt(const AnimationSampler& sampler, std::size_t component, double seconds) {
  return double{valueAt(sampler, seconds)[static_cast<glm::length_t>(component)]};
}

// Fractions of interval k, above 0 and below 1, at which the derivative of a component of a cubic spline is 0. With the
// values a and b, and the tangents m and n times the length of the interval, the spline is
//   (2a - 2b + m + n) t³ + (3b - 3a - 2m - n) t² + m t + a.
std::vector<double> extrema(const AnimationSampler& sampler, std::size_t component, std::size_t k) {
  if (sampler.interpolation != Interpolation::cubicSpline) return {};
  const auto part = [&](std::size_t key, std::size_t which) {
    return double{sampler.values[(3 * key + which) * sampler.valueSize + component]};
  };
  const double length = double{sampler.times[k + 1]} - double{sampler.times[k]};
  const double a = part(k, 1), b = part(k + 1, 1), m = length * part(k, 2), n = length * part(k + 1, 0);
  const double c2 = 3 * (2 * a - 2 * b + m + n), c1 = 2 * (3 * b - 3 * a - 2 * m - n), c0 = m;
  std::vector<double> roots;
  const double discriminant = c1 * c1 - 4 * c2 * c0;
  if (c2 == 0.0) {
    if (c1 != 0.0) roots = {-c0 / c1};
  } else if (discriminant >= 0.0) {
    // Citardauq's formula avoids the cancellation of nearly equal terms.
    const double q = -0.5 * (c1 + std::copysign(std::sqrt(discriminant), c1));
    roots = {q / c2};
    if (q != 0.0) roots.push_back(c0 / q);
  }
  std::erase_if(roots, [](double t) { return !(t > 0.0 && t < 1.0); });
  std::ranges::sort(roots);
  return roots;
}

// The time between `from` and `to` at which a monotone component passes the threshold.
double crossing(const AnimationSampler& sampler, std::size_t component, double threshold, double from, double to) {
  const bool rises = componentAt(sampler, component, to) > threshold;
  for (int i = 0; i < 32; ++i) {
    const double middle = 0.5 * (from + to);
    (componentAt(sampler, component, middle) > threshold) == rises ? to = middle : from = middle;
  }
  return to;
}

// Adds the times between which a component is monotone and passes no threshold.
void addTimes(const AnimationSampler& sampler, std::size_t component, std::set<double>& times) {
  for (const float time : sampler.times) times.insert(double{time});
  if (sampler.interpolation == Interpolation::step) return;
  for (std::size_t k = 0; k + 1 < sampler.times.size(); ++k) {
    const double begin = double{sampler.times[k]}, length = double{sampler.times[k + 1]} - begin;
    std::vector<double> turns{begin};
    for (const double t : extrema(sampler, component, k)) turns.push_back(begin + t * length);
    turns.push_back(begin + length);
    times.insert(turns.begin(), turns.end());
    for (std::size_t i = 0; i + 1 < turns.size(); ++i) {
      const double a = componentAt(sampler, component, turns[i]), b = componentAt(sampler, component, turns[i + 1]);
      for (const double threshold : kThresholds)
        if ((a - threshold) * (b - threshold) < 0.0)
          times.insert(crossing(sampler, component, threshold, turns[i], turns[i + 1]));
    }
  }
}

// Collects the states that differ in a feature or are brighter than those before.
class States {
 public:
  States(const Material& material, std::span<const AnimatedValue> values, const NodeAnimation& animation)
      : material_(material), values_(values), animation_(animation) {
    pose_.values.resize(animation.values.size());
  }

  void add(double seconds) {
    std::vector<int> classes;
    for (const AnimatedValue& value : values_) {
      const AnimationSampler& sampler = animation_.animation.samplers[animation_.values[value.value]];
      vec4& current = pose_.values[value.value];
      current = valueAt(sampler, seconds);
      for (std::size_t c = 0; c < sampler.valueSize; ++c)
        classes.push_back(classOf(double{current[static_cast<glm::length_t>(c)]}));
    }
    Material state = materialAt(material_, values_, pose_);
    const bool brighter = glm::any(glm::greaterThan(state.emissive, brightest_));
    if (!known_.insert(std::move(classes)).second && !brighter) return;
    brightest_ = glm::max(brightest_, state.emissive);
    states_.push_back(std::move(state));
  }
  std::vector<Material> take() { return std::move(states_); }

 private:
  // Position relative to the thresholds: even on one of them, odd between them.
  static int classOf(double value) {
    int result = -1;
    for (const double threshold : kThresholds) result += (value >= threshold) + (value > threshold);
    return result;
  }

  const Material& material_;
  std::span<const AnimatedValue> values_;
  const NodeAnimation& animation_;
  Pose pose_;
  std::set<std::vector<int>> known_;
  vec3 brightest_{-1.0f};
  std::vector<Material> states_;
};

}  // namespace

std::vector<Material> materialStates(const Material& material, std::span<const AnimatedValue> values,
                                     const NodeAnimation& animation) {
  std::set<double> times;
  for (const AnimatedValue& value : values) {
    const AnimationSampler& sampler = animation.animation.samplers[animation.values[value.value]];
    for (std::size_t c = 0; c < sampler.valueSize; ++c) addTimes(sampler, c, times);
  }
  States states(material, values, animation);
  for (auto next = times.begin(); next != times.end();) {
    const double time = *next++;
    states.add(time);
    if (next != times.end()) states.add(0.5 * (time + *next));
  }
  return states.take();
}

}  // namespace quintet::scene
