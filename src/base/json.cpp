// SPDX-License-Identifier: Apache-2.0
#include "base/json.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/text.h"

namespace quintet {
namespace {

// The position of the last character of a comment that begins at `at`; `at` itself if none does.
std::size_t endOfComment(std::string_view text, std::size_t at) {
  const std::string_view begin = text.substr(at, 2);
  if (begin == "//") return std::min(text.find('\n', at), text.size());
  if (begin != "/*") return at;
  const std::size_t end = text.find("*/", at + 2);
  return end == text.npos ? text.size() : end + 1;
}

}  // namespace

std::string lineAndColumn(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const auto line = 1 + std::ranges::count(before, '\n');
  const std::size_t start = before.rfind('\n') + 1;  // npos + 1 = 0
  return fmt::format("line {}, column {}", line, std::max<std::size_t>(1, before.size() - start));
}

void requireJsonLimits(std::string_view text, const JsonLimits& limits) {
  if (text.size() > limits.bytes)
    throw JsonLimitError(
        fmt::format("the JSON has {}; the limit is {}", bytesText(text.size()), bytesText(limits.bytes)), "");
  int depth = 0;
  bool inString = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inString) {
      if (c == '\\') ++i;
      inString = c != '"';
      continue;
    }
    inString = c == '"';
    if (c == '/' && limits.comments) i = endOfComment(text, i);
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kMaxJsonDepth)
      throw JsonLimitError(fmt::format("more than {} nested arrays and objects", kMaxJsonDepth),
                           lineAndColumn(text, i + 1));
  }
}

}  // namespace quintet
