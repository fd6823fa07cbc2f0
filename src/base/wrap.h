// SPDX-License-Identifier: Apache-2.0
// Text in columns: widths in characters, and lines that break between words.
#ifndef QUINTET_BASE_WRAP_H
#define QUINTET_BASE_WRAP_H

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace quintet {

// Returns the number of code points of UTF-8 text without sequences that set colors, which is the number of columns for the scripts that messages use.
std::size_t columnsOf(std::string_view text);

// Returns the text with spaces appended, so that it has at least this many columns.
std::string padded(std::string_view text, std::size_t columns);

// Returns lines of at most `width` columns, broken at spaces and at line breaks of the text. Longer words stay whole. At
// least one line.
std::vector<std::string> wrapText(std::string_view text, std::size_t width);

// Returns the same as one text: `indent` spaces before each line but the first, which starts at column `first`. `width` counts
// from column 0. No line break at the end.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent, std::size_t first = 0);

// Returns lines in two columns, with a line break at the end: `right` starts at `column`, in the next line if `left` leaves no
// room for two spaces between them.
std::string twoColumns(std::string_view left, std::string_view right, std::size_t column, std::size_t width);

}  // namespace quintet
#endif
