// SPDX-License-Identifier: Apache-2.0
// Typographic quotes that word processors and web pages put into commands and programs.
#ifndef QUINTET_BASE_TYPOGRAPHIC_H
#define QUINTET_BASE_TYPOGRAPHIC_H

#include <string>
#include <string_view>

namespace quintet {

// Returns the first of “ ” ‘ ’ in the text, as UTF-8; empty if there is none.
std::string_view findTypographicQuote(std::string_view text);

// Returns the ASCII quote, " or ', that the result of findTypographicQuote() stands for.
char asciiQuote(std::string_view quote);

// Returns "“ is a typographic quote; type \" instead" for the result of findTypographicQuote().
std::string typographicQuoteHint(std::string_view quote);

}  // namespace quintet
#endif
