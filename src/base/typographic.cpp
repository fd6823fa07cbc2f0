// SPDX-License-Identifier: Apache-2.0
#include "base/typographic.h"

namespace quintet {

std::string_view findTypographicQuote(std::string_view text) {
  constexpr std::string_view kPrefix = "\xE2\x80";  // U+2018, U+2019, U+201C and U+201D end in 98, 99, 9C and 9D
  for (std::size_t at = text.find(kPrefix); at != text.npos; at = text.find(kPrefix, at + 1)) {
    const std::string_view quote = text.substr(at, 3);
    if (quote.size() == 3 && std::string_view("\x98\x99\x9C\x9D").find(quote[2]) != quote.npos) return quote;
  }
  return {};
}

char asciiQuote(std::string_view quote) { return quote.ends_with('\x98') || quote.ends_with('\x99') ? '\'' : '"'; }

std::string typographicQuoteHint(std::string_view quote) {
  return std::string(quote) + " is a typographic quote; type " + asciiQuote(quote) + " instead";
}

}  // namespace quintet
