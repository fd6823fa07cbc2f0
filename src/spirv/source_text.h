// SPDX-License-Identifier: Apache-2.0
// Lines and tokens of GLSL source text, as diagnostics need them.
#ifndef QUINTET_SPIRV_SOURCE_TEXT_H
#define QUINTET_SPIRV_SOURCE_TEXT_H

#include <string_view>

namespace quintet::spirv {

// True for letters, digits and '_'.
bool isWordCharacter(char c);

// Returns a line (1-based) without its line break; empty if the text has fewer lines.
std::string_view lineOf(std::string_view text, int line);

// Returns the offset of the first occurrence of a token at or after `from`, or npos. A token that starts or ends with a
// word character matches whole words only.
std::size_t findToken(std::string_view text, std::string_view token, std::size_t from = 0);

}  // namespace quintet::spirv
#endif
