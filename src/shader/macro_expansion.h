// SPDX-License-Identifier: Apache-2.0
// How many tokens the preprocessor makes of a shader. Thirty lines of macros, each of which names the one before twice, become 2^30
// tokens, for which glslang needs more memory than a machine has. It has no limit of its own and cannot be stopped.
#ifndef QUINTET_SHADER_MACRO_EXPANSION_H
#define QUINTET_SHADER_MACRO_EXPANSION_H

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace quintet::shader {

// The largest shader of Quintet has 0.2 million.
inline constexpr double kMaxTokens = 4e6;
inline constexpr double kTokenBytes = 250;  // that glslang needs for a token of an expression

struct MacroText {
  std::string name;  // of the file
  std::string_view text;
};

struct LargeExpansion {
  std::string macro;
  std::string file;  // and line of the use that exceeds the limit
  int line = 0;
};

// The use with which `texts` exceed kMaxTokens, macros of `defines` (name, value) included; nothing if they do not. The number is
// that of the tokens if all branches of #if were compiled, and each text once. Recurses as deep as macros and their arguments are
// nested (deep_stack.h).
std::optional<LargeExpansion> findLargeExpansion(const std::vector<MacroText>& texts,
                                                 const std::vector<std::pair<std::string, std::string>>& defines);

}  // namespace quintet::shader
#endif
