// SPDX-License-Identifier: Apache-2.0
#include "base/toml_value.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"

#define TOML_EXCEPTIONS 1
#define TOML_ENABLE_FORMATTERS 0
// In debug builds the parser (3.3.0) asserts conditions that malformed text violates, such as a value that begins with
// ','. Without the assertion it reports its own error for such text.
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>

namespace quintet {
namespace {

// More than the parser allows in brackets (256), less than dotted keys could add to that.
constexpr int kMaxDepth = 300;

// Returns the position behind a string that begins at `at` with a quote; the end of the text if the string is not
// closed. A single-line string ends at the end of its line.
std::size_t skipString(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string_view triple = quote == '"' ? "\"\"\"" : "'''";
  const bool multiLine = text.substr(at, 3) == triple;
  at += multiLine ? 3 : 1;
  while (at < text.size()) {
    if (quote == '"' && text[at] == '\\') {
      at += 2;
    } else if (multiLine && text.substr(at, 3) == triple) {
      at += 3;
      while (at < text.size() && text[at] == quote) ++at;  // """a""""": quotes before the closing ones
      return at;
    } else if (!multiLine && (text[at] == quote || text[at] == '\n')) {
      return text[at] == quote ? at + 1 : at;
    } else {
      ++at;
    }
  }
  return text.size();
}

// Returns the line of the first dotted key with more than kMaxTomlKeyDots dots; 0 if no key has so many. toml++ (3.x)
// frees nested tables recursively: a key "a.a.a.…" of 200,000 parts overflows the stack. The answer is meaningless
// after text that is not TOML, where the parser reports its error first.
int lineOfDeepKey(std::string_view text) {
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

class Converter {
 public:
  explicit Converter(const std::filesystem::path& file) : file_(file) {}

  TomlValue operator()(const toml::node& node, int parentLine, int depth = 0) const {
    TomlValue value;
    // Tables that a header only implies have no line of their own.
    const auto line = static_cast<int>(node.source().begin.line);
    value.line = line > 0 ? line : parentLine;
    if (depth > kMaxDepth)
      throw FileError(file_, fmt::format("line {}", value.line), fmt::format("more than {} nested levels", kMaxDepth));
    if (const toml::table* table = node.as_table()) {
      value.kind = TomlValue::Kind::table;
      for (const auto& [key, member] : *table)
        value.members.push_back({std::string(key.str()), (*this)(member, value.line, depth + 1)});
      std::ranges::sort(value.members, {}, &TomlMember::key);
    } else if (const toml::array* array = node.as_array()) {
      value.kind = TomlValue::Kind::array;
      value.elements.reserve(array->size());
      for (const toml::node& element : *array) value.elements.push_back((*this)(element, value.line, depth + 1));
    } else if (const auto* text = node.as_string()) {
      value.kind = TomlValue::Kind::text;
      value.text = **text;
    } else if (const auto* boolean = node.as_boolean()) {
      value.kind = TomlValue::Kind::boolean;
      value.boolean = **boolean;
    } else if (const auto* integer = node.as_integer()) {
      value.kind = TomlValue::Kind::integer;
      value.integer = **integer;
      value.real = static_cast<double>(**integer);
    } else if (const auto* real = node.as_floating_point()) {
      value.kind = TomlValue::Kind::real;
      value.real = **real;
    } else {
      throw FileError(file_, fmt::format("line {}", value.line), "dates and times are not supported");
    }
    return value;
  }

 private:
  const std::filesystem::path& file_;
};

}  // namespace

const TomlValue* TomlValue::find(std::string_view key) const {
  const auto found =
      std::ranges::lower_bound(members, key, {}, [](const auto& member) { return std::string_view(member.key); });
  return found != members.end() && found->key == key ? &found->value : nullptr;
}

TomlValue parseToml(std::string_view text, const std::filesystem::path& file) {
  if (const int line = lineOfDeepKey(text); line > 0)
    throw FileError(file, fmt::format("line {}", line), fmt::format("more than {} dots in a key", kMaxTomlKeyDots));
  try {
    return Converter(file)(toml::parse(text), 1);
  } catch (const toml::parse_error& error) {
    throw FileError(file, fmt::format("line {}", std::max<unsigned>(1, error.source().begin.line)),
                    printable(error.description()));
  }
}

}  // namespace quintet
