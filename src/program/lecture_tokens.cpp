#include "program/lecture_tokens.h"

#include <algorithm>
#include <cctype>

namespace quintet::program {
namespace {

bool isWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

// One past the end of the comment that begins at `at`.
std::size_t endOfComment(std::string_view text, std::size_t at) {
  if (text[at + 1] == '*') {
    const std::size_t end = text.find("*/", at + 2);
    return end == text.npos ? text.size() : end + 2;
  }
  std::size_t end = at;
  while (true) {  // a backslash at the end continues the comment on the next line
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

// Follows #if … #endif while the tokens are made.
class Conditionals {
 public:
  // What `line` changes, for the tokens after it.
  void apply(const Directive& line, int& braces, int& parens) {
    if (line.name == "if" || line.name == "ifdef" || line.name == "ifndef") {
      const bool zero = line.name == "if" && line.rest == "0";
      open_.push_back({braces, parens, zero});
      deadCount_ += zero ? 1 : 0;
    } else if ((line.name == "else" || line.name == "elif") && !open_.empty()) {
      Branch& branch = open_.back();
      deadCount_ -= branch.dead ? 1 : 0;
      branch.dead = false;
      braces = branch.braces;
      parens = branch.parens;
    } else if (line.name == "endif" && !open_.empty()) {
      if (open_.back().dead) {
        braces = open_.back().braces;
        parens = open_.back().parens;
        --deadCount_;
      }
      open_.pop_back();
    }
  }
  bool dead() const { return deadCount_ > 0; }

 private:
  struct Branch {
    int braces;
    int parens;
    bool dead;
  };
  std::vector<Branch> open_;
  std::size_t deadCount_ = 0;
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
    Token token{TokenKind::mark, at, at + 1, conditionals.dead(), braces, parens};
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
    } else if (!token.dead) {
      braces += c == '{' ? 1 : c == '}' ? -1 : 0;
      parens += c == '(' ? 1 : c == ')' ? -1 : 0;
    }
    if (token.kind != TokenKind::comment) lineStart = false;
    at = token.end;
    tokens.push_back(token);
  }
  return tokens;
}

std::size_t nextCode(const std::vector<Token>& tokens, std::size_t from) {
  while (from < tokens.size() &&
         (tokens[from].dead || tokens[from].kind == TokenKind::comment || tokens[from].kind == TokenKind::directive))
    ++from;
  return std::min(from, tokens.size());
}

Place placeOf(std::string_view text, std::size_t offset) {
  const std::string_view before = text.substr(0, offset);
  const std::size_t newline = before.rfind('\n');
  return {1 + static_cast<int>(std::ranges::count(before, '\n')),
          1 + static_cast<int>(newline == before.npos ? before.size() : before.size() - newline - 1)};
}

}  // namespace quintet::program
