// Where GLSL source declares a variable that stages share. SPIR-V has neither the line nor, for payloads and callable
// data, the location.
#ifndef QUINTET_SHADER_GLSL_DECLARATION_H
#define QUINTET_SHADER_GLSL_DECLARATION_H

#include <optional>
#include <string>
#include <string_view>

namespace quintet::shader {

struct GlslDeclaration {
  std::string file;  // by the last #line "file" before it; empty: the text itself
  int line = 0;      // of the name, 1-based, by the last #line
  int column = 0;
  std::optional<int> location;  // if it is written as a number
};

// The declaration of `name` with the storage qualifier `keyword` ("rayPayloadInEXT") in `text`; comments do not count,
// what the preprocessor leaves out does.
std::optional<GlslDeclaration> findDeclaration(std::string_view text, std::string_view keyword, std::string_view name);

// The first place of a word in `text`; comments do not count.
std::optional<GlslDeclaration> findWord(std::string_view text, std::string_view word);

}  // namespace quintet::shader
#endif
