// SPDX-License-Identifier: Apache-2.0
#include "spirv/source_text.h"

#include <cctype>

namespace quintet::spirv {

bool isWordCharacter(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

std::string_view lineOf(std::string_view text, int line) {
  for (int i = 1; i < line && !text.empty(); ++i) {
    const std::size_t end = text.find('\n');
    text = end == text.npos ? std::string_view() : text.substr(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

std::size_t findToken(std::string_view text, std::string_view token, std::size_t from) {
  if (token.empty()) return text.npos;
  for (std::size_t at = text.find(token, from); at != text.npos; at = text.find(token, at + 1)) {
    const std::size_t end = at + token.size();
    const bool startsWord = at == 0 || !isWordCharacter(token.front()) || !isWordCharacter(text[at - 1]);
    const bool endsWord = end >= text.size() || !isWordCharacter(token.back()) || !isWordCharacter(text[end]);
    if (startsWord && endsWord) return at;
  }
  return text.npos;
}

}  // namespace quintet::spirv
