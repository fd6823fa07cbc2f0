// SPDX-License-Identifier: Apache-2.0
#include "program/lecture/uniforms.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <tuple>

#include "base/text.h"
#include "base/typographic.h"

namespace quintet::program {
namespace {

constexpr std::size_t kMaxUniforms = 256;

// Returns the number of "0.5", "1.0f" or "true"; empty for other texts.
std::optional<double> numberOf(std::string_view text) {
  text = trimmed(text);
  if (text == "true") return 1.0;
  if (text == "false") return 0.0;
  if (text.ends_with('f') || text.ends_with('F')) text.remove_suffix(1);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

// Returns the numbers of "0.5, 1, 0", "[0.5, 1, 0]" or "vec3(0.5)"; empty if a part is not a number.
std::optional<std::vector<double>> numbersOf(std::string_view text) {
  text = trimmed(text);
  const std::size_t open = text.find_first_of("([");
  if (open != text.npos) {
    const std::size_t close = text.find_last_of(")]");
    if (close == text.npos || close < open || !trimmed(text.substr(close + 1)).empty()) return {};
    text = text.substr(open + 1, close - open - 1);
  }
  std::vector<double> numbers;
  while (true) {
    const std::size_t comma = text.find(',');
    const std::optional<double> number = numberOf(text.substr(0, comma));
    if (!number || numbers.size() == 16) return {};
    numbers.push_back(*number);
    if (comma == text.npos) return numbers;
    text.remove_prefix(comma + 1);
  }
}

// Returns the quote at the start of the text; empty if there is none.
std::string_view quoteAtStart(std::string_view text) {
  if (text.starts_with('"') || text.starts_with('\'')) return text.substr(0, 1);
  return findTypographicQuote(text.substr(0, 3));
}

// Returns the offset of the quote that ends the value after `open`; npos if there is none.
std::size_t closingQuote(std::string_view text, std::size_t from, std::string_view open) {
  if (open.size() == 1) return text.find(open, from);
  while (true) {
    const std::string_view quote = findTypographicQuote(text.substr(from));
    if (quote.empty()) return text.npos;
    from = static_cast<std::size_t>(quote.data() - text.data());
    if (asciiQuote(quote) == asciiQuote(open)) return from;
    from += quote.size();
  }
}

// Returns the pairs key="value" of a comment; keys in lower case. The quotes can be typographic.
std::map<std::string, std::string> attributesOf(std::string_view comment) {
  std::map<std::string, std::string> result;
  for (std::size_t equals = comment.find('='); equals != comment.npos; equals = comment.find('=', equals + 1)) {
    const std::size_t first = std::min(comment.find_first_not_of(" \t", equals + 1), comment.size());
    const std::string_view open = quoteAtStart(comment.substr(first));
    if (open.empty()) continue;
    const std::size_t value = first + open.size();
    const std::size_t close = closingQuote(comment, value, open);
    if (close == comment.npos) break;
    std::size_t end = equals;
    while (end > 0 && (comment[end - 1] == ' ' || comment[end - 1] == '\t')) --end;
    std::size_t begin = end;
    while (begin > 0 && (std::isalnum(static_cast<unsigned char>(comment[begin - 1])) || comment[begin - 1] == '_'))
      --begin;
    if (begin < end) result[lowerCase(comment.substr(begin, end - begin))] = comment.substr(value, close - value);
    equals = close;
  }
  return result;
}

constexpr std::array<std::pair<std::string_view, ParameterType>, 8> kTypes{{{"float", ParameterType::real},
                                                                            {"uint", ParameterType::uinteger},
                                                                            {"sampler2D", ParameterType::image},
                                                                            {"vec2", ParameterType::vec2},
                                                                            {"vec3", ParameterType::vec3},
                                                                            {"vec4", ParameterType::vec4},
                                                                            {"int", ParameterType::integer},
                                                                            {"bool", ParameterType::boolean}}};

bool setType(Parameter& parameter, std::string_view type) {
  for (const auto& [name, value] : kTypes) {
    if (type != name) continue;
    parameter.type = value;
    parameter.sRgb = false;  // images hold display values, like the output
    return true;
  }
  return false;
}

// Reads declarations that start with the token "uniform".
class DeclarationReader {
 public:
  DeclarationReader(const LectureText& source, LectureErrors& errors)
      : source_(source), text_(source.text), tokens_(source.tokens), errors_(errors) {}

  // Appends the uniforms of one declaration. Returns the token of its end.
  std::size_t read(std::size_t first, std::vector<LectureUniform>& uniforms) {
    std::size_t last = first;
    while (last < tokens_.size() && !(isMark(last, ';') && tokens_[last].braces == 0))
      last = source_.nextCode(last + 1);
    if (last == tokens_.size()) return last;  // the compiler reports it
    if (!checkQuotes(first, last)) return last;
    std::size_t at = source_.nextCode(first + 1);
    while (at < last && (word(at) == "highp" || word(at) == "mediump" || word(at) == "lowp"))
      at = source_.nextCode(at + 1);
    const std::size_t typeToken = at;
    readAttributes(last);
    while (at < last) {
      const std::size_t name = source_.nextCode(at + 1);
      std::size_t end = name;
      while (end < last && !(isMark(end, ',') && tokens_[end].parens == tokens_[name].parens))
        end = source_.nextCode(end + 1);
      LectureUniform uniform;
      uniform.begin = tokens_[layoutBefore(first)].begin;
      uniform.end = tokens_[last].end;
      if (readOne(uniform, typeToken, name, end))
        uniforms.push_back(std::move(uniform));
      else
        break;
      at = end;
    }
    return last;
  }

 private:
  bool isMark(std::size_t i, char c) const { return source_.isMark(i, c); }
  std::string_view word(std::size_t i) const { return source_.textOf(i); }

  // Returns the token "layout" of "layout(…) uniform", or `first` if the declaration has no layout.
  std::size_t layoutBefore(std::size_t first) const {
    constexpr std::size_t kLongest = 16;  // layout ( set = 0 , binding = 3 )
    for (std::size_t back = 1; back <= std::min(first, kLongest); ++back) {
      const std::size_t i = first - back;
      if (back == 1 && !isMark(i, ')')) break;
      if (tokens_[i].parens == 0) return i > 0 && word(i - 1) == "layout" ? i - 1 : first;  // token i is the '('
    }
    return first;
  }

  // Returns false after an error for the first typographic quote outside comments.
  bool checkQuotes(std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; i = source_.nextCode(i + 1))
      if (const std::string_view quote = findTypographicQuote(text_.substr(tokens_[i].begin, 3)); !quote.empty())
        return fail(i, typographicQuoteHint(quote));
    return true;
  }

  // Reads the comment after the declaration in the same line.
  void readAttributes(std::size_t last) {
    attributes_.clear();
    if (last + 1 >= tokens_.size() || tokens_[last + 1].kind != TokenKind::comment) return;
    const Token& comment = tokens_[last + 1];
    const std::string_view between = text_.substr(tokens_[last].end, comment.begin - tokens_[last].end);
    if (between.find('\n') == between.npos) attributes_ = attributesOf(source_.textOf(last + 1));
  }

  bool fail(std::size_t token, const std::string& problem) {
    errors_.add("Q015", tokens_[token].begin, problem);
    return false;
  }

  bool readOne(LectureUniform& uniform, std::size_t type, std::size_t name, std::size_t end) {
    Parameter& parameter = uniform.parameter;
    if (name >= end || tokens_[name].kind != TokenKind::word)
      return fail(type, "a uniform must be declared as 'uniform TYPE NAME;' (uniform blocks are not supported)");
    if (!setType(parameter, word(type)))
      return fail(
          type,
          fmt::format(
              "a uniform cannot have the type '{}'; available: float, vec2, vec3, vec4, int, uint, bool, sampler2D",
              word(type)));
    parameter.name = word(name);
    parameter.line = positionOf(text_, tokens_[name].begin).line;
    std::tie(parameter.min, parameter.max) = typeRange(parameter.type);
    std::string_view value;
    const std::size_t after = source_.nextCode(name + 1);
    if (after < end && isMark(after, '['))
      return fail(after, fmt::format("uniform '{}' must not be an array", parameter.name));
    if (after < end && isMark(after, '='))
      value = text_.substr(tokens_[after].end, tokens_[end].begin - tokens_[after].end);
    else if (after < end)
      return fail(after, "expected ';' or '='");
    if (parameter.type == ParameterType::image) parameter.defaultImage = attribute({"defaultval", "default"});
    return readRange(parameter, name) &&
           (parameter.type == ParameterType::image || readDefault(parameter, name, value));
  }

  std::string attribute(std::initializer_list<const char*> names) const {
    for (const char* name : names)
      if (const auto found = attributes_.find(name); found != attributes_.end()) return found->second;
    return {};
  }

  bool readRange(Parameter& parameter, std::size_t token) {
    if (parameter.type == ParameterType::vec3 &&
        (lowerCase(parameter.name).find("color") != std::string::npos ||
         lowerCase(parameter.name).find("colour") != std::string::npos || lowerCase(attribute({"type"})) == "color"))
      parameter.type = ParameterType::color;
    parameter.unit = attribute({"unit"});
    parameter.help = attribute({"help", "description", "label"});
    for (const char* name : {"min", "max"}) {
      const std::string text = attribute({name});
      if (text.empty()) continue;
      const std::optional<double> number = numberOf(text);
      if (!number)
        return fail(token, fmt::format("the {} of '{}' is not a number: {}", name, parameter.name, text.substr(0, 40)));
      (*name == 'm' && name[1] == 'i' ? parameter.min : parameter.max) = *number;
    }
    return true;
  }

  // The comment's defaultval takes precedence over the initializer. Without either, the default is 0, clamped to the range.
  bool readDefault(Parameter& parameter, std::size_t token, std::string_view initializer) {
    const std::string given = attribute({"defaultval", "default"});
    const std::string_view text = given.empty() ? initializer : given;
    const auto count = static_cast<std::size_t>(componentCount(parameter.type));
    std::vector<double> numbers(count, std::clamp(0.0, parameter.min, std::max(parameter.min, parameter.max)));
    if (!trimmed(text).empty()) {
      const auto parsed = numbersOf(text);
      if (!parsed || (parsed->size() != count && parsed->size() != 1))
        return fail(token, fmt::format("the default of '{}' must be {}", parameter.name,
                                       count == 1 ? "a number" : fmt::format("{} numbers", count)));
      numbers = parsed->size() == count ? *parsed : std::vector<double>(count, parsed->front());
    }
    const bool whole = isWhole(parameter.type);
    for (std::size_t i = 0; i < count; ++i) {
      if (whole && numbers[i] != std::floor(numbers[i]))
        return fail(token, fmt::format("the default of '{}' must be an integer", parameter.name));
      if (!(numbers[i] >= parameter.min && numbers[i] <= parameter.max))
        return fail(token, fmt::format("the default of '{}' is out of range ({} to {})", parameter.name, parameter.min,
                                       parameter.max));
      parameter.defaultValue[i] = numbers[i];
    }
    return true;
  }

  const LectureText& source_;
  std::string_view text_;
  const std::vector<Token>& tokens_;
  LectureErrors& errors_;
  std::map<std::string, std::string> attributes_;  // of the current declaration
};

}  // namespace

std::vector<LectureUniform> findUniforms(const LectureText& source, LectureErrors& errors) {
  std::vector<LectureUniform> uniforms;
  DeclarationReader reader(source, errors);
  const std::vector<Token>& tokens = source.tokens;
  for (std::size_t i = source.nextCode(0); i < tokens.size(); i = source.nextCode(i + 1)) {
    if (tokens[i].braces != 0 || tokens[i].parens != 0 || !source.isWord(i, "uniform")) continue;
    i = reader.read(i, uniforms);
    if (i >= tokens.size()) break;
    if (uniforms.size() <= kMaxUniforms) continue;
    errors.add("Q015", tokens[i].begin, fmt::format("more than {} uniforms", kMaxUniforms));
    break;
  }
  return uniforms;
}

bool isPredeclared(std::string_view name) { return name == "frameID" || name == "frameSize"; }

std::optional<LectureUniform> implicitUniform(std::string_view name) {
  LectureUniform uniform;
  uniform.parameter.name = name;
  if (name.size() == 10 && name.starts_with("userParam") && name[9] >= '0' && name[9] <= '2') return uniform;
  setType(uniform.parameter, "sampler2D");
  if (name.size() == 8 && name.starts_with("texture") && name[7] >= '0' && name[7] <= '4') return uniform;
  return {};
}

}  // namespace quintet::program
