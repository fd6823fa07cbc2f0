// SPDX-License-Identifier: Apache-2.0
#include "shader/macro_expansion.h"

#include <algorithm>
#include <cstddef>
#include <unordered_map>

#include "spirv/source_text.h"

namespace quintet::shader {
namespace {

struct Token {
  std::string_view text;  // one character if it is no word
  int line = 0;
  std::size_t match = 0;  // of '(': the position of its ')'; 0 if there is none

  bool isName() const { return !(text.front() >= '0' && text.front() <= '9') && spirv::isWordCharacter(text.front()); }
};
using Tokens = std::vector<Token>;

void matchParentheses(Tokens& tokens) {
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    if (tokens[i].text == "(") open.push_back(i);
    if (tokens[i].text != ")" || open.empty()) continue;
    tokens[open.back()].match = i;
    open.pop_back();
  }
}

// Reads words and characters, without comments and white space, and joins lines that end with a backslash.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  // The next token of this line; nothing at its end.
  std::optional<Token> next() {
    skip();
    if (at_ >= text_.size() || text_[at_] == '\n') return {};
    const std::size_t begin = at_++;
    if (spirv::isWordCharacter(text_[begin]))
      while (at_ < text_.size() && spirv::isWordCharacter(text_[at_])) ++at_;
    return Token{text_.substr(begin, at_ - begin), line_};
  }
  // Whether '(' follows without a space: then a macro has parameters.
  bool opens() const { return at_ < text_.size() && text_[at_] == '('; }
  bool nextLine() {
    skip();
    if (at_ >= text_.size()) return false;
    ++at_;
    ++line_;
    return true;
  }

 private:
  bool starts(std::string_view text) const { return text_.substr(at_, text.size()) == text; }

  void skip() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v') {
        ++at_;
      } else if (starts("\\\n") || starts("\\\r\n")) {
        at_ = text_.find('\n', at_) + 1;
        ++line_;
      } else if (starts("//")) {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (starts("/*")) {
        const std::size_t end = std::min(text_.find("*/", at_ + 2), text_.size());
        line_ += static_cast<int>(std::ranges::count(text_.substr(at_, end - at_), '\n'));
        at_ = std::min(end + 2, text_.size());
      } else {
        return;
      }
    }
  }

  const std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

// A number of tokens as a function of those of the arguments.
struct Size {
  double tokens = 0;
  std::vector<double> perArgument;

  void add(const Size& other, double times = 1) {
    tokens += times * other.tokens;
    perArgument.resize(std::max(perArgument.size(), other.perArgument.size()));
    for (std::size_t i = 0; i < other.perArgument.size(); ++i) perArgument[i] += times * other.perArgument[i];
  }
  void enlarge(const Size& other) {
    tokens = std::max(tokens, other.tokens);
    perArgument.resize(std::max(perArgument.size(), other.perArgument.size()));
    for (std::size_t i = 0; i < other.perArgument.size(); ++i)
      perArgument[i] = std::max(perArgument[i], other.perArgument[i]);
  }
};

struct Definition {
  std::vector<std::string_view> parameters;
  bool hasParameters = false;
  Tokens body;
};

struct Macro {
  std::vector<Definition> definitions;  // of the same name, at different locations
  std::optional<Size> size;
  bool active = false;  // its size is being computed: the preprocessor does not expand a macro in itself
};

class Expansion {
 public:
  void define(std::string_view name, Definition definition) {
    matchParentheses(definition.body);
    macros_[name].definitions.push_back(std::move(definition));
  }

  // Definitions become macros; the rest are the tokens.
  Tokens read(std::string_view text) {
    Tokens tokens;
    Reader reader(text);
    do {
      std::optional<Token> token = reader.next();
      if (token && token->text == "#") {
        token = reader.next();
        const std::string_view directive = token ? token->text : "";
        if (directive == "define") readDefinition(reader);
        if (directive != "if" && directive != "elif") token.reset();  // the rest of other directives is not expanded
      }
      for (; token; token = reader.next()) tokens.push_back(*token);
      while (reader.next()) {
      }
    } while (reader.nextLine());
    matchParentheses(tokens);
    return tokens;
  }

  // Adds the size of a token, which can be the begin of a use of a macro, to `total`. Returns the position behind it.
  std::size_t addToken(const Tokens& tokens, std::size_t at, const std::vector<std::string_view>& parameters,
                       Size& total) {
    const Token& token = tokens[at];
    if (!token.isName()) {
      ++total.tokens;
      return at + 1;
    }
    if (const auto parameter = std::ranges::find(parameters, token.text); parameter != parameters.end()) {
      Size argument;
      argument.perArgument.resize(static_cast<std::size_t>(parameter - parameters.begin()) + 1);
      argument.perArgument.back() = 1;
      total.add(argument);
      return at + 1;
    }
    Macro* macro = called(token.text);
    if (!macro) {
      ++total.tokens;
      return at + 1;
    }
    const Size& size = sizeOf(*macro);
    total.tokens += size.tokens;
    const bool hasParameters =
        std::ranges::any_of(macro->definitions, [](const Definition& d) { return d.hasParameters; });
    const std::size_t open = at + 1;
    if (!hasParameters || open >= tokens.size() || tokens[open].text != "(" || tokens[open].match == 0) return open;
    std::size_t argument = 0;
    Size part;
    for (std::size_t i = open + 1; i <= tokens[open].match;) {
      if (i == tokens[open].match || tokens[i].text == ",") {
        if (argument < size.perArgument.size()) total.add(part, size.perArgument[argument]);
        part = {};
        ++argument;
        ++i;
      } else if (tokens[i].text == "(" && tokens[i].match != 0) {
        const std::size_t end = tokens[i].match;
        for (; i <= end;) i = addToken(tokens, i, parameters, part);
      } else {
        i = addToken(tokens, i, parameters, part);
      }
    }
    return tokens[open].match + 1;
  }

 private:
  void readDefinition(Reader& reader) {
    const std::optional<Token> name = reader.next();
    if (!name || !name->isName()) return;
    Definition definition;
    definition.hasParameters = reader.opens();
    std::optional<Token> token = reader.next();
    if (definition.hasParameters) {
      while ((token = reader.next()) && token->text != ")")
        if (token->isName()) definition.parameters.push_back(token->text);
      token = reader.next();
    }
    for (; token; token = reader.next()) definition.body.push_back(*token);
    define(name->text, std::move(definition));
  }

  // The macro that a name stands for: `#define A B` makes A(x) a use of B, if B has parameters.
  Macro* called(std::string_view name) {
    Macro* result = nullptr;
    constexpr int kMaxSteps = 64;
    for (int steps = 0; steps < kMaxSteps; ++steps) {
      const auto found = macros_.find(name);
      if (found == macros_.end() || found->second.active) return result;
      result = &found->second;
      const std::vector<Definition>& definitions = result->definitions;
      if (definitions.size() != 1 || definitions[0].hasParameters || definitions[0].body.size() != 1) return result;
      name = definitions[0].body[0].text;
    }
    return result;
  }

  const Size& sizeOf(Macro& macro) {
    if (macro.size) return *macro.size;
    macro.active = true;
    Size largest;
    for (const Definition& definition : macro.definitions) {
      Size size;
      for (std::size_t i = 0; i < definition.body.size();)
        i = addToken(definition.body, i, definition.parameters, size);
      largest.enlarge(size);
    }
    macro.active = false;
    return macro.size.emplace(std::move(largest));
  }

  std::unordered_map<std::string_view, Macro> macros_;
};

}  // namespace

std::optional<LargeExpansion> findLargeExpansion(const std::vector<MacroText>& texts,
                                                 const std::vector<std::pair<std::string, std::string>>& defines) {
  Expansion expansion;
  for (const auto& [name, value] : defines) expansion.define(name, {.parameters = {}, .body = expansion.read(value)});
  std::vector<Tokens> tokens;
  for (const MacroText& text : texts) tokens.push_back(expansion.read(text.text));
  double total = 0;
  for (std::size_t i = 0; i < texts.size(); ++i)
    for (std::size_t at = 0; at < tokens[i].size();) {
      const Token& token = tokens[i][at];
      Size size;
      at = expansion.addToken(tokens[i], at, {}, size);
      total += size.tokens;
      if (total > kMaxTokens) return LargeExpansion{std::string(token.text), texts[i].name, token.line};
    }
  return {};
}

}  // namespace quintet::shader
