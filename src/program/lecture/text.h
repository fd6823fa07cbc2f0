// SPDX-License-Identifier: Apache-2.0
// The text of a lecture-form file as the front end reads it: tokens with nesting depth, the names that it uses and
// declares, positions, and errors. Any bytes are accepted.
#ifndef QUINTET_PROGRAM_LECTURE_TEXT_H
#define QUINTET_PROGRAM_LECTURE_TEXT_H

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/diagnostic.h"

namespace quintet::program {

enum class TokenKind {
  word,       // identifier, keyword or number
  mark,       // one character
  comment,    // including its slashes and stars
  directive,  // a preprocessor line from its '#' to the end of the line, continuation lines included
};

struct Token {
  TokenKind kind = TokenKind::mark;
  std::size_t begin = 0;  // offset in the text
  std::size_t end = 0;    // one past the last byte
  bool inactive = false;  // between #if 0 and its #else or #endif
  // Number of { and ( that are open before the token. If a conditional has several branches, the last one counts. A
  // brace closes all parentheses, and so does a ';' outside functions.
  int braces = 0;
  int parens = 0;
};

std::vector<Token> tokenize(std::string_view text);

inline std::string_view textOf(std::string_view text, const Token& token) {
  return text.substr(token.begin, token.end - token.begin);
}

// The parts of a preprocessor line: "ifdef" and "X" of "#  ifdef X".
struct Directive {
  std::string_view name;
  std::string_view rest;
};
Directive directiveOf(std::string_view line);

// A 1-based position in a text; columns count bytes.
struct TextPosition {
  int line = 1;
  int column = 1;
};
TextPosition positionOf(std::string_view text, std::size_t offset);

// A text with its tokens. The text must outlive it. Token indices past the end are valid arguments: such a token is
// neither a mark nor a word.
struct LectureText {
  LectureText() = default;
  explicit LectureText(std::string_view source) : text(source), tokens(tokenize(source)) {}

  std::string_view text;
  std::vector<Token> tokens;

  std::string_view textOf(std::size_t token) const { return program::textOf(text, tokens[token]); }
  bool isMark(std::size_t token, char mark) const {
    return token < tokens.size() && tokens[token].kind == TokenKind::mark && text[tokens[token].begin] == mark;
  }
  bool isWord(std::size_t token, std::string_view word) const {
    return token < tokens.size() && tokens[token].kind == TokenKind::word && textOf(token) == word;
  }
  // Returns the index of the first token from `from` on that is neither a comment nor a directive nor inactive;
  // tokens.size() if none.
  std::size_t nextCode(std::size_t from) const;

  // Words outside comments and inactive branches.
  std::set<std::string_view> words() const;
  // Returns whether the name is declared outside functions or defined as a macro.
  bool declares(std::string_view name) const;
  // Returns whether the name is a struct or declared otherwise.
  bool definesType(std::string_view name) const;
};

// Collects the errors of one file, 50 at most.
class LectureErrors {
 public:
  LectureErrors(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}
  void add(std::string id, std::size_t offset, std::string problem);
  const std::vector<Diagnostic>& all() const { return all_; }

 private:
  std::string_view text_;
  std::string file_;
  std::vector<Diagnostic> all_;
};

}  // namespace quintet::program
#endif
