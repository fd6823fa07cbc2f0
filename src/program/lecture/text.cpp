// SPDX-License-Identifier: Apache-2.0
#include "program/lecture/text.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace quintet::program {
namespace {

bool isWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

// Returns the offset one past the end of the comment that starts at `at`.
std::size_t endOfComment(std::string_view text, std::size_t at) {
  if (text[at + 1] == '*') {
    const std::size_t end = text.find("*/", at + 2);
    return end == text.npos ? text.size() : end + 2;
  }
  std::size_t end = at;
  while (true) {  // a backslash at the end of a line continues the comment
    end = text.find('\n', end);
    if (end == text.npos) return text.size();
    std::size_t last = end;
    if (last > at && text[last - 1] == '\r') --last;
    if (last == at || text[last - 1] != '\\') return end;
    ++end;
  }
}

bool startsComment(std::string_view text, std::size_t at) {
  return text[at] == '/' && at + 1 < text.size() && (text[at + 1] == '/' || text[at + 1] == '*');
}

std::size_t endOfDirective(std::string_view text, std::size_t at) {
  while (at < text.size()) {
    if (startsComment(text, at)) {
      at = endOfComment(text, at);
    } else if (text[at] == '\\') {
      ++at;
      if (at < text.size() && text[at] == '\r') ++at;
      if (at < text.size()) ++at;
    } else if (text[at] == '\n') {
      return at;
    } else {
      ++at;
    }
  }
  return text.size();
}

// Tracks #if … #endif while the text is split into tokens.
class Conditionals {
 public:
  // Applies a directive to the state of the tokens after it.
  void apply(const Directive& line, int& braces, int& parens) {
    if (line.name == "if" || line.name == "ifdef" || line.name == "ifndef") {
      const bool zero = line.name == "if" && line.rest == "0";
      open_.push_back({braces, parens, zero});
      inactiveCount_ += zero ? 1 : 0;
    } else if ((line.name == "else" || line.name == "elif") && !open_.empty()) {
      Branch& branch = open_.back();
      inactiveCount_ -= branch.inactive ? 1 : 0;
      branch.inactive = false;
      braces = branch.braces;
      parens = branch.parens;
    } else if (line.name == "endif" && !open_.empty()) {
      if (open_.back().inactive) {
        braces = open_.back().braces;
        parens = open_.back().parens;
        --inactiveCount_;
      }
      open_.pop_back();
    }
  }
  bool inactive() const { return inactiveCount_ > 0; }

 private:
  struct Branch {
    int braces;
    int parens;
    bool inactive;
  };
  std::vector<Branch> open_;
  std::size_t inactiveCount_ = 0;
};

}  // namespace

Directive directiveOf(std::string_view line) {
  std::size_t at = 1;
  while (at < line.size() && isBlank(line[at])) ++at;
  std::size_t end = at;
  while (end < line.size() && isWord(line[end])) ++end;
  Directive result{line.substr(at, end - at), line.substr(end)};
  for (std::size_t i = 0; i < result.rest.size(); ++i) {
    if (!startsComment(result.rest, i)) continue;
    result.rest = result.rest.substr(0, i);
    break;
  }
  while (!result.rest.empty() && isBlank(result.rest.front())) result.rest.remove_prefix(1);
  while (!result.rest.empty() && isBlank(result.rest.back())) result.rest.remove_suffix(1);
  return result;
}

std::vector<Token> tokenize(std::string_view text) {
  std::vector<Token> tokens;
  Conditionals conditionals;
  int braces = 0;
  int parens = 0;
  bool lineStart = true;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == '\n' || isBlank(c)) {
      lineStart = lineStart || c == '\n';
      ++at;
      continue;
    }
    Token token{TokenKind::mark, at, at + 1, conditionals.inactive(), braces, parens};
    if (startsComment(text, at)) {
      token.kind = TokenKind::comment;
      token.end = endOfComment(text, at);
    } else if (c == '#' && lineStart) {
      token.kind = TokenKind::directive;
      token.end = endOfDirective(text, at);
      conditionals.apply(directiveOf(textOf(text, token)), braces, parens);
    } else if (isWord(c)) {
      token.kind = TokenKind::word;
      while (token.end < text.size() && isWord(text[token.end])) ++token.end;
    } else if (!token.inactive) {
      parens += c == '(' ? 1 : c == ')' ? -1 : 0;
      // In GLSL, neither a brace nor the end of a declaration outside functions can be inside parentheses. So a missing
      // ')' affects only the code up to there, and the declarations after it are still found.
      if (c == '{' || c == '}' || (c == ';' && braces == 0)) parens = 0;
      braces += c == '{' ? 1 : c == '}' ? -1 : 0;
    }
    if (token.kind != TokenKind::comment) lineStart = false;
    at = token.end;
    tokens.push_back(token);
  }
  return tokens;
}

TextPosition positionOf(std::string_view text, std::size_t offset) {
  const std::string_view before = text.substr(0, offset);
  const std::size_t newline = before.rfind('\n');
  return {1 + static_cast<int>(std::ranges::count(before, '\n')),
          1 + static_cast<int>(newline == before.npos ? before.size() : before.size() - newline - 1)};
}

std::size_t LectureText::nextCode(std::size_t from) const {
  const auto isCode = [](const Token& token) {
    return !token.inactive && (token.kind == TokenKind::word || token.kind == TokenKind::mark);
  };
  while (from < tokens.size() && !isCode(tokens[from])) ++from;
  return std::min(from, tokens.size());
}

std::set<std::string_view> LectureText::words() const {
  std::set<std::string_view> words;
  for (std::size_t i = 0; i < tokens.size(); ++i)
    if (tokens[i].kind == TokenKind::word && !tokens[i].inactive) words.insert(textOf(i));
  return words;
}

bool LectureText::declares(std::string_view name) const {
  std::size_t before = tokens.size();  // the previous code token
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const Token& token = tokens[i];
    if (token.inactive || token.kind == TokenKind::comment) continue;
    if (token.kind == TokenKind::directive) {
      const Directive line = directiveOf(textOf(i));
      if (line.name == "define" && line.rest.substr(0, line.rest.find_first_of(" \t(")) == name) return true;
      continue;
    }
    // A declarator outside functions follows its type or a comma.
    if (isWord(i, name) && token.braces == 0 && token.parens == 0 && before < tokens.size() &&
        (tokens[before].kind == TokenKind::word || textOf(before) == ","))
      return true;
    before = i;
  }
  return false;
}

bool LectureText::definesType(std::string_view name) const {
  for (std::size_t i = 0; i < tokens.size(); ++i)
    if (!tokens[i].inactive && isWord(i, "struct"))
      if (const std::size_t next = nextCode(i + 1); next < tokens.size() && textOf(next) == name) return true;
  return declares(name);
}

void LectureErrors::add(std::string id, std::size_t offset, std::string problem) {
  constexpr std::size_t kMaxErrors = 50;
  if (all_.size() >= kMaxErrors) return;
  const TextPosition position = positionOf(text_, offset);
  all_.push_back({Severity::error, file_, position.line, position.column, std::move(id), std::move(problem)});
}

}  // namespace quintet::program
