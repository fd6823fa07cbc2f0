// SPDX-License-Identifier: Apache-2.0
#include "spirv/glsl_declaration.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <system_error>

#include "spirv/source_text.h"

namespace quintet::spirv {
namespace {

// Replaces comments by spaces, so that offsets and lines stay the same.
std::string withoutComments(std::string_view text) {
  std::string result(text);
  for (std::size_t i = 0; i + 1 < result.size(); ++i) {
    if (result[i] != '/') continue;
    const bool line = result[i + 1] == '/';
    if (!line && result[i + 1] != '*') continue;
    std::size_t end = line ? result.find('\n', i) : result.find("*/", i + 2);
    end = end == result.npos ? result.size() : line ? end : end + 2;
    for (; i < end; ++i)
      if (result[i] != '\n') result[i] = ' ';
    --i;
  }
  return result;
}

// Returns the offset of the ';' that ends the declaration, outside of braces.
std::size_t endOf(std::string_view text, std::size_t at) {
  for (int depth = 0; at < text.size(); ++at) {
    if (text[at] == '{') ++depth;
    if (text[at] == '}') --depth;
    if (text[at] == ';' && depth <= 0) return at;
  }
  return text.npos;
}

// Returns the start of the last word before `end`, ignoring array sizes such as "[3]".
std::size_t lastWord(std::string_view text, std::size_t begin, std::size_t end) {
  for (std::size_t at = end; at > begin;) {
    --at;
    if (text[at] == ']') {
      while (at > begin && text[at] != '[') --at;
    } else if (isWordCharacter(text[at])) {
      while (at > begin && isWordCharacter(text[at - 1])) --at;
      return at;
    }
  }
  return text.npos;
}

std::optional<int> locationIn(std::string_view qualifiers) {
  std::size_t at = findToken(qualifiers, "location");
  if (at == qualifiers.npos) return {};
  at = qualifiers.find_first_not_of(" \t\n=", at + 8);
  if (at == qualifiers.npos) return {};
  int value = 0;
  const auto [end, failed] = std::from_chars(qualifiers.data() + at, qualifiers.data() + qualifiers.size(), value);
  const bool whole = end == qualifiers.data() + qualifiers.size() || !isWordCharacter(*end) || *end == 'u';
  return failed == std::errc{} && whole ? std::optional(value) : std::nullopt;
}

// Sets the file, line and column of an offset according to #line directives.
void setLocation(std::string_view text, std::size_t offset, GlslDeclaration& result) {
  const std::size_t lineStart = text.substr(0, offset).rfind('\n');
  result.column = static_cast<int>(offset - (lineStart == text.npos ? 0 : lineStart + 1)) + 1;
  result.line = 1;
  for (std::size_t begin = 0; begin < offset;) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end >= offset) break;
    const std::string_view line = text.substr(begin, end - begin);
    ++result.line;
    begin = end + 1;
    if (!line.starts_with("#line ")) continue;
    const std::size_t digit = line.find_first_not_of(' ', 6);
    int number = 0;
    if (digit == line.npos || std::from_chars(line.data() + digit, line.data() + line.size(), number).ec != std::errc{})
      continue;
    result.line = number;
    if (const std::size_t quote = line.find('"'); quote != line.npos)
      result.file = line.substr(quote + 1, line.find('"', quote + 1) - quote - 1);
  }
}

}  // namespace

std::optional<GlslDeclaration> findDeclaration(std::string_view source, std::string_view keyword,
                                               std::string_view name) {
  if (source.find(keyword) == source.npos) return {};
  const std::string text = withoutComments(source);
  for (std::size_t at = findToken(text, keyword); at != text.npos; at = findToken(text, keyword, at + 1)) {
    const std::size_t end = endOf(text, at);
    if (end == text.npos) return {};
    const std::size_t word = lastWord(text, at + keyword.size(), end);
    if (word == text.npos || text.compare(word, name.size(), name) != 0 || isWordCharacter(text[word + name.size()]))
      continue;
    GlslDeclaration result;
    setLocation(text, word, result);
    const std::size_t before = text.find_last_of(";}", at);
    const std::size_t begin = before == text.npos ? 0 : before + 1;
    result.location = locationIn(std::string_view(text).substr(begin, word - begin));
    return result;
  }
  return {};
}

std::optional<GlslDeclaration> findWord(std::string_view source, std::string_view word) {
  const std::string text = withoutComments(source);
  const std::size_t at = findToken(text, word);
  if (at == text.npos) return {};
  GlslDeclaration result;
  setLocation(text, at, result);
  return result;
}

}  // namespace quintet::spirv
