#include "base/toml_depth.h"

namespace quintet {
namespace {

// The position behind a string that begins at `at` with a quote; the text's end if it is not closed. A string of one
// line ends at the line's end.
std::size_t skipString(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string_view triple = quote == '"' ? "\"\"\"" : "'''";
  const bool lines = text.substr(at, 3) == triple;
  at += lines ? 3 : 1;
  while (at < text.size()) {
    if (quote == '"' && text[at] == '\\') {
      at += 2;
    } else if (lines && text.substr(at, 3) == triple) {
      at += 3;
      while (at < text.size() && text[at] == quote) ++at;  // """a""""": quotes before the closing ones
      return at;
    } else if (!lines && (text[at] == quote || text[at] == '\n')) {
      return text[at] == quote ? at + 1 : at;
    } else {
      ++at;
    }
  }
  return text.size();
}

}  // namespace

int deepTomlKey(std::string_view text) {
  int line = 1, dots = 0;
  for (std::size_t at = 0; at < text.size();) {
    switch (text[at]) {
      case '"':
      case '\'': {
        const std::size_t end = skipString(text, at);
        for (; at < end; ++at) line += text[at] == '\n';
        continue;
      }
      case '#':
        while (at < text.size() && text[at] != '\n') ++at;
        continue;
      case '.':
        if (++dots > kMaxTomlKeyDots) return line;
        break;
      case '\n': ++line; [[fallthrough]];
      case '=':
      case ',':
      case '[':
      case ']':
      case '{':
      case '}': dots = 0; break;
      default: break;
    }
    ++at;
  }
  return 0;
}

}  // namespace quintet
