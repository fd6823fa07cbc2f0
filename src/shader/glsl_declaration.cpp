#include "shader/glsl_declaration.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string>

namespace quintet::shader {
namespace {

bool isWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

// The text with comments as spaces, line by line as before.
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

std::size_t wordAt(std::string_view text, std::string_view word, std::size_t from) {
  for (std::size_t at = text.find(word, from); at != text.npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !isWord(text[at - 1])) && (end >= text.size() || !isWord(text[end]))) return at;
  }
  return text.npos;
}

// The ';' that ends the declaration, outside of braces.
std::size_t endOf(std::string_view text, std::size_t at) {
  for (int depth = 0; at < text.size(); ++at) {
    if (text[at] == '{') ++depth;
    if (text[at] == '}') --depth;
    if (text[at] == ';' && depth <= 0) return at;
  }
  return text.npos;
}

// Start of the last word before `end`, leaving out "[3]".
std::size_t lastWord(std::string_view text, std::size_t begin, std::size_t end) {
  for (std::size_t at = end; at > begin;) {
    --at;
    if (text[at] == ']') {
      while (at > begin && text[at] != '[') --at;
    } else if (isWord(text[at])) {
      while (at > begin && isWord(text[at - 1])) --at;
      return at;
    }
  }
  return text.npos;
}

std::optional<int> locationIn(std::string_view qualifiers) {
  std::size_t at = wordAt(qualifiers, "location", 0);
  if (at == qualifiers.npos) return {};
  at = qualifiers.find_first_not_of(" \t\n=", at + 8);
  if (at == qualifiers.npos) return {};
  int value = 0;
  const auto [end, failed] = std::from_chars(qualifiers.data() + at, qualifiers.data() + qualifiers.size(), value);
  const bool whole = end == qualifiers.data() + qualifiers.size() || !isWord(*end) || *end == 'u';
  return failed == std::errc{} && whole ? std::optional(value) : std::nullopt;
}

// Line and column of a position, and the file, as #line directives have them.
void place(std::string_view text, std::size_t position, GlslDeclaration& result) {
  const std::size_t lineStart = text.substr(0, position).rfind('\n');
  result.column = static_cast<int>(position - (lineStart == text.npos ? 0 : lineStart + 1)) + 1;
  result.line = 1;
  for (std::size_t begin = 0; begin < position;) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end >= position) break;
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
  for (std::size_t at = wordAt(text, keyword, 0); at != text.npos; at = wordAt(text, keyword, at + 1)) {
    const std::size_t end = endOf(text, at);
    if (end == text.npos) return {};
    const std::size_t word = lastWord(text, at + keyword.size(), end);
    if (word == text.npos || text.compare(word, name.size(), name) != 0 || isWord(text[word + name.size()])) continue;
    GlslDeclaration result;
    place(text, word, result);
    const std::size_t before = text.find_last_of(";}", at);
    const std::size_t begin = before == text.npos ? 0 : before + 1;
    result.location = locationIn(std::string_view(text).substr(begin, word - begin));
    return result;
  }
  return {};
}

std::optional<GlslDeclaration> findWord(std::string_view source, std::string_view word) {
  const std::string text = withoutComments(source);
  const std::size_t at = wordAt(text, word, 0);
  if (at == text.npos) return {};
  GlslDeclaration result;
  place(text, at, result);
  return result;
}

}  // namespace quintet::shader
