#include "program/lecture_uniforms.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <tuple>

namespace quintet::program {
namespace {

constexpr std::size_t kMaxUniforms = 256;

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

// "0.5", "1.0f", "true"; nothing else.
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

// "0.5, 1, 0"; with brackets or as "vec3(0.5)", too. Nothing if a part is not a number.
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

// The pairs key="value" of a comment.
std::map<std::string, std::string> attributesOf(std::string_view comment) {
  std::map<std::string, std::string> result;
  for (std::size_t equals = comment.find('='); equals != comment.npos; equals = comment.find('=', equals + 1)) {
    std::size_t first = comment.find_first_not_of(" \t", equals + 1);
    if (first == comment.npos || (comment[first] != '"' && comment[first] != '\'')) continue;
    const std::size_t close = comment.find(comment[first], first + 1);
    if (close == comment.npos) break;
    std::size_t end = equals;
    while (end > 0 && (comment[end - 1] == ' ' || comment[end - 1] == '\t')) --end;
    std::size_t begin = end;
    while (begin > 0 && (std::isalnum(static_cast<unsigned char>(comment[begin - 1])) || comment[begin - 1] == '_'))
      --begin;
    if (begin < end) result[lower(comment.substr(begin, end - begin))] = comment.substr(first + 1, close - first - 1);
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
    parameter.sRgb = false;  // images hold what is shown, like the picture
    return true;
  }
  return false;
}

// Reads one declaration, from the token "uniform" on.
class Declaration {
 public:
  Declaration(std::string_view text, const std::vector<Token>& tokens, LectureErrors& errors)
      : text_(text), tokens_(tokens), errors_(errors) {}

  // Appends its uniforms; returns the token of its end.
  std::size_t read(std::size_t first, std::vector<LectureUniform>& uniforms) {
    std::size_t last = first;
    while (last < tokens_.size() && !(isMark(last, ';') && tokens_[last].braces == 0))
      last = nextCode(tokens_, last + 1);
    if (last == tokens_.size()) return last;  // the compiler says it
    std::size_t at = nextCode(tokens_, first + 1);
    while (at < last && (word(at) == "highp" || word(at) == "mediump" || word(at) == "lowp"))
      at = nextCode(tokens_, at + 1);
    const std::size_t typeToken = at;
    readAttributes(last);
    while (at < last) {
      const std::size_t name = nextCode(tokens_, at + 1);
      std::size_t end = name;
      while (end < last && !(isMark(end, ',') && tokens_[end].parens == tokens_[name].parens))
        end = nextCode(tokens_, end + 1);
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
  bool isMark(std::size_t i, char c) const {
    return tokens_[i].kind == TokenKind::mark && text_[tokens_[i].begin] == c;
  }
  std::string_view word(std::size_t i) const { return textOf(text_, tokens_[i]); }

  // The token "layout" of "layout(…) uniform", or `first` itself.
  std::size_t layoutBefore(std::size_t first) const {
    constexpr std::size_t kLongest = 16;  // layout ( set = 0 , binding = 3 )
    for (std::size_t back = 1; back <= std::min(first, kLongest); ++back) {
      const std::size_t i = first - back;
      if (back == 1 && !isMark(i, ')')) break;
      if (tokens_[i].parens == 0) return i > 0 && word(i - 1) == "layout" ? i - 1 : first;  // i: the '('
    }
    return first;
  }

  // The comment behind the declaration, in the same line.
  void readAttributes(std::size_t last) {
    attributes_.clear();
    if (last + 1 >= tokens_.size() || tokens_[last + 1].kind != TokenKind::comment) return;
    const Token& comment = tokens_[last + 1];
    const std::string_view between = text_.substr(tokens_[last].end, comment.begin - tokens_[last].end);
    if (between.find('\n') == between.npos) attributes_ = attributesOf(textOf(text_, comment));
  }

  bool fail(std::size_t token, const std::string& problem) {
    errors_.add("Q015", tokens_[token].begin, problem);
    return false;
  }

  bool readOne(LectureUniform& uniform, std::size_t type, std::size_t name, std::size_t end) {
    Parameter& parameter = uniform.parameter;
    if (name >= end || tokens_[name].kind != TokenKind::word)
      return fail(type, "a uniform is declared as 'uniform TYPE NAME;' (blocks of uniforms are not known)");
    if (!setType(parameter, word(type)))
      return fail(
          type,
          fmt::format("'{}' is no type of a uniform; there are float, vec2, vec3, vec4, int, uint, bool and sampler2D",
                      word(type)));
    parameter.name = word(name);
    parameter.line = placeOf(text_, tokens_[name].begin).line;
    std::tie(parameter.min, parameter.max) = typeRange(parameter.type);
    std::string_view value;
    const std::size_t after = nextCode(tokens_, name + 1);
    if (after < end && isMark(after, '['))
      return fail(after, fmt::format("the uniform '{}' must not be an array", parameter.name));
    if (after < end && isMark(after, '='))
      value = text_.substr(tokens_[after].end, tokens_[end].begin - tokens_[after].end);
    else if (after < end)
      return fail(after, "';' or '=' is missing here");
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
        (lower(parameter.name).find("color") != std::string::npos ||
         lower(parameter.name).find("colour") != std::string::npos || lower(attribute({"type"})) == "color"))
      parameter.type = ParameterType::color;
    parameter.unit = attribute({"unit"});
    parameter.help = attribute({"help", "description", "label"});
    for (const char* name : {"min", "max"}) {
      const std::string text = attribute({name});
      if (text.empty()) continue;
      const std::optional<double> number = numberOf(text);
      if (!number)
        return fail(token, fmt::format("the {} of '{}' is no number: {}", name, parameter.name, text.substr(0, 40)));
      (*name == 'm' && name[1] == 'i' ? parameter.min : parameter.max) = *number;
    }
    return true;
  }

  // The comment's defaultval wins over the initializer; neither: zero, as far as the range allows it.
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
        return fail(token, fmt::format("the default of '{}' must be a whole number", parameter.name));
      if (!(numbers[i] >= parameter.min && numbers[i] <= parameter.max))
        return fail(
            token, fmt::format("the default of '{}' is outside {} … {}", parameter.name, parameter.min, parameter.max));
      parameter.defaultValue[i] = numbers[i];
    }
    return true;
  }

  std::string_view text_;
  const std::vector<Token>& tokens_;
  LectureErrors& errors_;
  std::map<std::string, std::string> attributes_;
};

}  // namespace

std::vector<LectureUniform> findUniforms(std::string_view text, const std::vector<Token>& tokens,
                                         LectureErrors& errors) {
  std::vector<LectureUniform> uniforms;
  Declaration declaration(text, tokens, errors);
  for (std::size_t i = nextCode(tokens, 0); i < tokens.size(); i = nextCode(tokens, i + 1)) {
    if (tokens[i].kind != TokenKind::word || tokens[i].braces != 0 || tokens[i].parens != 0 ||
        textOf(text, tokens[i]) != "uniform")
      continue;
    i = declaration.read(i, uniforms);
    if (i >= tokens.size()) break;
    if (uniforms.size() <= kMaxUniforms) continue;
    errors.add("Q015", tokens[i].begin, fmt::format("more than {} uniforms are no program", kMaxUniforms));
    break;
  }
  return uniforms;
}

bool isLectureName(std::string_view name) { return name == "frameID" || name == "frameSize"; }

std::optional<LectureUniform> implicitUniform(std::string_view name) {
  LectureUniform uniform;
  uniform.parameter.name = name;
  if (name.size() == 10 && name.starts_with("userParam") && name[9] >= '0' && name[9] <= '2') return uniform;
  setType(uniform.parameter, "sampler2D");
  if (name.size() == 8 && name.starts_with("texture") && name[7] >= '0' && name[7] <= '4') return uniform;
  return {};
}

}  // namespace quintet::program
