// SPDX-License-Identifier: Apache-2.0
#include "viewer/false_color.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "render/tone_map/false_color.h"

namespace quintet::viewer {
namespace {

// 1, 2 or 5 times a power of ten: the smallest that is at least `value`.
double roundUp(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= value * (1.0 - 1e-9)) return factor * power;
  return 10.0 * power;
}

std::string label(double value) { return fmt::format("{:.4g}", value == 0.0 ? 0.0 : value); }

}  // namespace

double FalseColorRange::position(double value) const {
  if (std::isnan(value)) return value;
  double result = 0.0;
  if (logarithmic)
    result = value <= least ? 0.0 : std::log(value / least) / std::log(most / least);
  else
    result = (value - least) / (most - least);
  return std::clamp(result, 0.0, 1.0);
}

double FalseColorRange::valueAt(double position) const {
  return logarithmic ? least * std::pow(most / least, position) : least + position * (most - least);
}

vec3 falseColor(double position) {
  if (std::isnan(position)) return {1.0f, 0.0f, 1.0f};
  return render::viridis(static_cast<float>(position));
}

std::vector<LegendTick> legendTicks(const FalseColorRange& range, int count) {
  std::vector<LegendTick> ticks;
  if (!(range.most > range.least) || !std::isfinite(range.most - range.least) || count < 1) return ticks;
  if (range.logarithmic) {
    const int first = static_cast<int>(std::ceil(std::log10(range.least) - 1e-9));
    const int last = static_cast<int>(std::floor(std::log10(range.most) + 1e-9));
    const int step = std::max(1, (last - first + count - 1) / count);
    for (int exponent = first; exponent <= last; exponent += step) {
      const double value = std::pow(10.0, exponent);
      ticks.push_back({range.position(value), label(value)});
    }
    return ticks;
  }
  const double step = roundUp((range.most - range.least) / count);
  const double first = std::ceil(range.least / step - 1e-9);
  for (double i = first; i * step <= range.most + 1e-9 * step; ++i)
    ticks.push_back({range.position(i * step), label(i * step)});
  return ticks;
}

FalseColorRange roundRange(double least, double most) {
  if (!std::isfinite(least) || !std::isfinite(most)) return {};
  if (!(most > least)) most = least + std::max(1.0, std::abs(least)) * 1e-3;
  const double step = roundUp((most - least) / 10.0);
  return {std::floor(least / step + 1e-9) * step, std::ceil(most / step - 1e-9) * step, false};
}

}  // namespace quintet::viewer
