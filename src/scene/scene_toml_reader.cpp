#include "scene/scene_toml_reader.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/nearest_name.h"
#include "io/color.h"
#include "scene/printable.h"

namespace quintet::scene {
namespace {

std::string describe(const NumberRange& r) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  if (r.low <= -kLargest && r.high >= kLargest) return "";
  if (r.high >= kLargest)
    return fmt::format(" {} {}", r.lowExcluded ? "above" : "from", r.low) + (r.lowExcluded ? "" : " up");
  if (r.lowExcluded || r.highExcluded) return fmt::format(" between {} and {}", r.low, r.high);
  return fmt::format(" from {} to {}", r.low, r.high);
}

bool contains(const NumberRange& r, double x) {
  return (r.lowExcluded ? x > r.low : x >= r.low) && (r.highExcluded ? x < r.high : x <= r.high);
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

void failAt(const std::filesystem::path& file, const TomlValue& at, std::string_view problem) {
  throw FileError(file, fmt::format("line {}", at.line), printable(problem));
}

std::string didYouMean(const std::string& name, const std::vector<std::string>& candidates) {
  if (name.size() > 64) return {};
  const std::string nearest = nearestName(name, candidates);
  return nearest.empty() ? std::string() : fmt::format("; did you mean '{}'?", nearest);
}

TomlReader::TomlReader(const TomlValue& table, std::string what, const std::filesystem::path& file)
    : table_(table), what_(std::move(what)), file_(file) {
  if (table.kind != TomlValue::Kind::table) fail(table, what_ + " must be a table");
}

const TomlValue* TomlReader::find(const std::string& key) {
  known_.insert(key);
  return table_.find(key);
}

const TomlValue& TomlReader::require(const std::string& key) {
  const TomlValue* value = find(key);
  if (!value) fail(table_, fmt::format("{} needs '{}'", what_, key));
  return *value;
}

const TomlValue* TomlReader::findOneOf(std::initializer_list<const char*> keys) {
  const TomlValue* found = nullptr;
  const char* name = "";
  for (const char* key : keys) {
    const TomlValue* value = find(key);
    if (!value) continue;
    if (found) fail(*value, fmt::format("'{}' and '{}' of {} exclude each other", name, key, what_));
    found = value;
    name = key;
  }
  return found;
}

std::string TomlReader::text(const std::string& key, std::string fallback) {
  const TomlValue* value = find(key);
  return value ? toText(*value, key) : fallback;
}

bool TomlReader::boolean(const std::string& key, bool fallback) {
  const TomlValue* value = find(key);
  if (!value) return fallback;
  if (value->kind != TomlValue::Kind::boolean) wrong(*value, key, "true or false");
  return value->boolean;
}

std::uint32_t TomlReader::integer(const std::string& key, std::uint32_t fallback, std::uint32_t low,
                                  std::uint32_t high) {
  const TomlValue* value = find(key);
  return value ? toInteger(*value, key, low, high) : fallback;
}

float TomlReader::number(const std::string& key, float fallback, const NumberRange& range) {
  const TomlValue* value = find(key);
  return value ? toNumber(*value, key, range) : fallback;
}

vec2 TomlReader::pair(const std::string& key, const vec2& fallback, const NumberRange& range) {
  const TomlValue* value = find(key);
  return value ? toPair(*value, key, range) : fallback;
}

vec3 TomlReader::triple(const std::string& key, const vec3& fallback, const NumberRange& range) {
  const TomlValue* value = find(key);
  return value ? toTriple(*value, key, range) : fallback;
}

vec3 TomlReader::color(const std::string& key, const vec3& fallback, const NumberRange& range) {
  const TomlValue* value = find(key);
  return value ? toColor(*value, key, range) : fallback;
}

std::size_t TomlReader::choice(const std::string& key, const std::vector<std::string>& names, std::size_t fallback) {
  const TomlValue* value = find(key);
  if (!value) return fallback;
  const std::string name = toText(*value, key);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return i;
  fail(*value, fmt::format("'{}' of {} is one of {}, not '{}'{}", key, what_, fmt::join(names, ", "), name,
                           didYouMean(name, names)));
}

const std::vector<TomlValue>& TomlReader::list(const std::string& key) {
  static const std::vector<TomlValue> kNothing;
  const TomlValue* value = find(key);
  if (!value) return kNothing;
  if (value->kind != TomlValue::Kind::array) wrong(*value, key, "a list");
  return value->elements;
}

float TomlReader::toNumber(const TomlValue& value, std::string_view name, const NumberRange& range) const {
  // The comparison is also false for NaN.
  if (!value.isNumber() || !contains(range, value.real)) wrong(value, name, "a number" + describe(range));
  return static_cast<float>(value.real);
}

std::uint32_t TomlReader::toInteger(const TomlValue& value, std::string_view name, std::uint32_t low,
                                    std::uint32_t high) const {
  if (value.kind != TomlValue::Kind::integer || value.integer < low || value.integer > high)
    wrong(value, name, fmt::format("a whole number from {} to {}", low, high));
  return static_cast<std::uint32_t>(value.integer);
}

std::string TomlReader::toText(const TomlValue& value, std::string_view name) const {
  if (value.kind != TomlValue::Kind::text) wrong(value, name, "a text in quotes");
  return value.text;
}

std::vector<float> TomlReader::toNumbers(const TomlValue& value, std::string_view name, std::size_t count,
                                         const NumberRange& range) const {
  if (value.kind != TomlValue::Kind::array || value.elements.size() != count)
    wrong(value, name, fmt::format("a list of {} numbers", count));
  std::vector<float> numbers;
  for (const TomlValue& element : value.elements) numbers.push_back(toNumber(element, name, range));
  return numbers;
}

vec2 TomlReader::toPair(const TomlValue& value, std::string_view name, const NumberRange& range) const {
  const std::vector<float> n = toNumbers(value, name, 2, range);
  return {n[0], n[1]};
}

vec3 TomlReader::toTriple(const TomlValue& value, std::string_view name, const NumberRange& range) const {
  const std::vector<float> n = toNumbers(value, name, 3, range);
  return {n[0], n[1], n[2]};
}

vec3 TomlReader::toColor(const TomlValue& value, std::string_view name, const NumberRange& range) const {
  if (value.kind != TomlValue::Kind::text) return toTriple(value, name, range);
  vec3 color(0.0f);
  bool valid = value.text.size() == 7 && value.text[0] == '#';
  for (std::size_t i = 0; valid && i < 3; ++i) {
    const int high = hexDigit(value.text[1 + 2 * i]), low = hexDigit(value.text[2 + 2 * i]);
    valid = high >= 0 && low >= 0;
    color[i] = io::linearFromSrgb(static_cast<float>(16 * high + low) / 255.0f);
  }
  if (!valid) wrong(value, name, "three linear numbers or an sRGB colour such as \"#ff8000\"");
  return color;
}

vec3 TomlReader::toDirection(const TomlValue& value, std::string_view name) const {
  const glm::dvec3 v(toTriple(value, name));
  const double length = glm::length(v);
  if (!(length > 0.0)) wrong(value, name, "a vector with a length");
  return vec3(v / length);
}

const TomlValue& TomlReader::toTable(const TomlValue& value, std::string_view name) const {
  if (value.kind != TomlValue::Kind::table) wrong(value, name, "a table { ... }");
  return value;
}

void TomlReader::finish() const {
  for (const auto& [key, value] : table_.members) {
    if (known_.contains(key)) continue;
    fail(value, fmt::format("{} has no key '{}'{}", what_, key, didYouMean(key, {known_.begin(), known_.end()})));
  }
}

void TomlReader::wrong(const TomlValue& value, std::string_view name, std::string_view wanted) const {
  fail(value, fmt::format("'{}' of {} must be {}", name, what_, wanted));
}

}  // namespace quintet::scene
