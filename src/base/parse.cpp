// SPDX-License-Identifier: Apache-2.0
#include "base/parse.h"

#include <cmath>

namespace quintet {

std::vector<std::string> splitText(std::string_view text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::optional<vec3> parseVec3(std::string_view text) {
  const std::vector<std::string> parts = splitText(text, ',');
  if (parts.size() != 3) return std::nullopt;
  vec3 result{0.0f};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<float> value = parseNumber<float>(parts[i]);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    result[static_cast<glm::length_t>(i)] = *value;
  }
  return result;
}

}  // namespace quintet
