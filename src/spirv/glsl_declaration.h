// SPDX-License-Identifier: Apache-2.0
// Finds the GLSL declaration of a variable that stages share. SPIR-V has neither its line nor, for payloads and
// callable data, its location.
#ifndef QUINTET_SPIRV_GLSL_DECLARATION_H
#define QUINTET_SPIRV_GLSL_DECLARATION_H

#include <optional>
#include <string>
#include <string_view>

namespace quintet::spirv {

struct GlslDeclaration {
  std::string file;  // from the last #line "file" before it; empty for the text itself
  int line = 0;      // of the name, 1-based, counted from the last #line
  int column = 0;
  std::optional<int> location;  // layout location, if it is a number
};

// Finds the declaration of `name` with the storage qualifier `keyword` ("rayPayloadInEXT"). Comments are skipped, but
// not the branches that the preprocessor disables.
std::optional<GlslDeclaration> findDeclaration(std::string_view text, std::string_view keyword, std::string_view name);

// Finds the first occurrence of a word outside of comments.
std::optional<GlslDeclaration> findWord(std::string_view text, std::string_view word);

}  // namespace quintet::spirv
#endif
