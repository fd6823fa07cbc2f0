// SPDX-License-Identifier: Apache-2.0
#include "base/wrap.h"

#include <algorithm>

namespace quintet {
namespace {

// As wrapText(), with a different width of the first line.
std::vector<std::string> wrapLines(std::string_view text, std::size_t firstWidth, std::size_t width) {
  std::vector<std::string> lines{""};
  std::size_t columns = 0;  // of the last line
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(" \n"), text.size());
    const std::string_view word = text.substr(0, end);
    if (!word.empty()) {
      const std::size_t size = columnsOf(word);
      if (columns > 0 && columns + 1 + size > (lines.size() == 1 ? firstWidth : width)) {
        lines.emplace_back();
        columns = 0;
      }
      if (columns > 0) lines.back() += ' ';
      columns += (columns > 0 ? 1 : 0) + size;
      lines.back() += word;
    }
    if (end < text.size() && text[end] == '\n') {
      lines.emplace_back();
      columns = 0;
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

}  // namespace

std::size_t columnsOf(std::string_view text) {
  std::size_t columns = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.substr(i, 2) == "\x1b[")
      i = std::min(text.find('m', i), text.size());
    else if ((text[i] & 0xC0) != 0x80)
      ++columns;
  }
  return columns;
}

std::string padded(std::string_view text, std::size_t columns) {
  const std::size_t size = columnsOf(text);
  return std::string(text) + std::string(size < columns ? columns - size : 0, ' ');
}

std::vector<std::string> wrapText(std::string_view text, std::size_t width) { return wrapLines(text, width, width); }

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent, std::size_t first) {
  const auto room = [width](std::size_t used) { return width > used ? width - used : 1; };
  std::string result;
  for (const std::string& line : wrapLines(text, room(first), room(indent))) {
    if (!result.empty()) result += line.empty() ? "\n" : "\n" + std::string(indent, ' ');
    result += line;
  }
  return result;
}

std::string twoColumns(std::string_view left, std::string_view right, std::size_t column, std::size_t width) {
  const bool fits = left.empty() || columnsOf(left) + 2 <= column;
  return (fits ? padded(left, column) : std::string(left) + "\n" + std::string(column, ' ')) +
         wrapped(right, width, column, column) + "\n";
}

}  // namespace quintet
