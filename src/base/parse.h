// SPDX-License-Identifier: Apache-2.0
// Numbers in text, without locale and without exceptions.
#ifndef QUINTET_BASE_PARSE_H
#define QUINTET_BASE_PARSE_H

#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/math.h"

namespace quintet {

// The number that the whole text stands for, with an optional sign; nothing for any other text.
template <class T>
std::optional<T> parseNumber(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  T value{};
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || stop != text.data() + text.size() || text.empty()) return std::nullopt;
  return value;
}

// The parts between separators, empty ones included; at least one.
std::vector<std::string> splitText(std::string_view text, char separator);

// "1,2.5,-3": three finite numbers; nothing for any other text.
std::optional<vec3> parseVec3(std::string_view text);

}  // namespace quintet
#endif
