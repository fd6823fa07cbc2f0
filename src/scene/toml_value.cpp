#include "scene/toml_value.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/toml.h"
#include "base/toml_depth.h"
#include "scene/printable.h"

namespace quintet::scene {
namespace {

// Deeper than the parser allows in brackets, less deep than dotted keys could add to that.
constexpr int kMaxDepth = 300;

class Converter {
 public:
  explicit Converter(const std::filesystem::path& file) : file_(file) {}

  TomlValue operator()(const toml::node& node, unsigned lineAbove, int depth = 0) const {
    TomlValue value;
    // Tables that a header only implies have no line of their own.
    value.line = node.source().begin.line ? node.source().begin.line : lineAbove;
    if (depth > kMaxDepth)
      throw FileError(file_, fmt::format("line {}", value.line), fmt::format("nested more than {} deep", kMaxDepth));
    if (const toml::table* table = node.as_table()) {
      value.kind = TomlValue::Kind::table;
      for (const auto& [key, member] : *table)
        value.members.emplace_back(std::string(key.str()), (*this)(member, value.line, depth + 1));
      std::ranges::sort(value.members, {}, &std::pair<std::string, TomlValue>::first);
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
      throw FileError(file_, fmt::format("line {}", value.line), "dates and times have no place in a scene");
    }
    return value;
  }

 private:
  const std::filesystem::path& file_;
};

}  // namespace

const TomlValue* TomlValue::find(std::string_view key) const {
  const auto found =
      std::ranges::lower_bound(members, key, {}, [](const auto& member) { return std::string_view(member.first); });
  return found != members.end() && found->first == key ? &found->second : nullptr;
}

TomlValue parseToml(std::string_view text, const std::filesystem::path& file) {
  if (const int line = deepTomlKey(text); line > 0)
    throw FileError(file, fmt::format("line {}", line),
                    fmt::format("a dotted key of more than {} levels", kMaxTomlKeyDots));
  try {
    return Converter(file)(toml::parse(text), 1);
  } catch (const toml::parse_error& error) {
    throw FileError(file, fmt::format("line {}", std::max<unsigned>(1, error.source().begin.line)),
                    printable(error.description()));
  }
}

}  // namespace quintet::scene
