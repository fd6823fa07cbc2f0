// SPDX-License-Identifier: Apache-2.0
#include "output/float_text.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace quintet::output {

std::string floatText(float value, int digits) {
  if (value == 0.0f) return "0";
  if (std::isnan(value)) return "nan";  // not "-nan"
  if (std::abs(value) >= std::numeric_limits<float>::max()) return value > 0.0f ? "infinity" : "-infinity";
  return fmt::format("{:.{}g}", value, digits);
}

std::string floatsText(std::span<const float> values, int digits) {
  std::string text;
  for (const float value : values) text += (text.empty() ? "" : " ") + floatText(value, digits);
  return text;
}

}  // namespace quintet::output
