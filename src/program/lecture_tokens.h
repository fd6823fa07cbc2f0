// The tokens of a lecture-form file, as far as its splitting needs them: words, punctuation, comments and
// preprocessor lines with their places. Any bytes are accepted.
#ifndef QUINTET_PROGRAM_LECTURE_TOKENS_H
#define QUINTET_PROGRAM_LECTURE_TOKENS_H

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace quintet::program {

enum class TokenKind {
  word,       // identifier, keyword or number
  mark,       // one character
  comment,    // with its slashes and stars
  directive,  // a preprocessor line from its '#' to the line's end, continuation lines included
};

struct Token {
  TokenKind kind = TokenKind::mark;
  std::size_t begin = 0;  // offsets in the text; end is one past the last byte
  std::size_t end = 0;
  bool dead = false;  // between #if 0 and its #else or #endif
  // Before the token: how many { and ( are open. Of several branches of a conditional the last one counts.
  int braces = 0;
  int parens = 0;
};

std::vector<Token> tokenize(std::string_view text);

inline std::string_view textOf(std::string_view text, const Token& token) {
  return text.substr(token.begin, token.end - token.begin);
}

// "ifdef" of "#  ifdef X", and what follows it.
struct Directive {
  std::string_view name;
  std::string_view rest;
};
Directive directiveOf(std::string_view line);

// The index of the next token that is neither comment nor directive nor dead, from `from` on; tokens.size(): none.
std::size_t nextCode(const std::vector<Token>& tokens, std::size_t from);

// 1-based place of an offset; columns count bytes.
struct Place {
  int line = 1;
  int column = 1;
};
Place placeOf(std::string_view text, std::size_t offset);

}  // namespace quintet::program
#endif
