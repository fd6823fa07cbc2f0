// SPDX-License-Identifier: Apache-2.0
#include "base/toml_reader.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/normal_float.h"
#include "base/suggestion.h"
#include "base/text.h"

namespace quintet {
namespace {

using Kind = TomlValue::Kind;

const std::vector<TomlValue>& noElements() {
  static const std::vector<TomlValue> kNone;
  return kNone;
}

// Returns " from 0 to 1"; empty for a range without bounds.
std::string describe(const NumberRange& r) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  if (r.low <= -kLargest && r.high >= kLargest) return "";
  if (r.high >= kLargest) return fmt::format(" {} {}", r.lowExcluded ? "above" : "of at least", r.low);
  if (r.lowExcluded || r.highExcluded) return fmt::format(" between {} and {}", r.low, r.high);
  return fmt::format(" from {} to {}", r.low, r.high);
}

// The float nearest to a number in the range, which can round to a limit that is excluded.
float inside(const NumberRange& r, float x) {
  if (r.lowExcluded && x <= r.low) return std::nextafter(static_cast<float>(r.low), std::numeric_limits<float>::max());
  if (r.highExcluded && x >= r.high)
    return std::nextafter(static_cast<float>(r.high), -std::numeric_limits<float>::max());
  return x;
}

// False for NaN.
bool contains(const NumberRange& r, double x) {
  return (r.lowExcluded ? x > r.low : x >= r.low) && (r.highExcluded ? x < r.high : x <= r.high);
}

}  // namespace

void failAt(const std::filesystem::path& file, const TomlValue& at, std::string_view problem) {
  throw FileError(file, fmt::format("line {}", at.line), printable(problem));
}

TomlReader::TomlReader(const TomlValue& table, std::string what, std::filesystem::path file)
    : table_(table), what_(std::move(what)), file_(std::move(file)) {
  if (table.kind != Kind::table) fail(what_ + " must be a table");
}

void TomlReader::failType(const TomlValue& value, std::string_view name, std::string_view expected) const {
  fail(value, fmt::format("'{}' of {} must be {}", name, what_, expected));
}

const TomlValue* TomlReader::find(const std::string& key) {
  known_.insert(key);
  return table_.find(key);
}

const TomlValue& TomlReader::require(const std::string& key) {
  const TomlValue* value = find(key);
  if (!value) fail(fmt::format("{} needs '{}'", what_, key));
  return *value;
}

const TomlValue* TomlReader::findOneOf(std::initializer_list<const char*> keys) {
  const TomlValue* found = nullptr;
  const char* name = "";
  for (const char* key : keys) {
    const TomlValue* value = find(key);
    if (!value) continue;
    if (found) fail(*value, fmt::format("'{}' and '{}' of {} are mutually exclusive", name, key, what_));
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
  if (value->kind != Kind::boolean) failType(*value, key, "true or false");
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

double TomlReader::number(const std::string& key, double fallback) {
  const TomlValue* value = find(key);
  if (!value) return fallback;
  if (!value->isNumber()) failType(*value, key, "a number");
  return value->real;
}

vec2 TomlReader::pair(const std::string& key, const vec2& fallback, const NumberRange& range) {
  const TomlValue* value = find(key);
  return value ? toPair(*value, key, range) : fallback;
}

vec3 TomlReader::triple(const std::string& key, const vec3& fallback, const NumberRange& range) {
  const TomlValue* value = find(key);
  return value ? toTriple(*value, key, range) : fallback;
}

std::size_t TomlReader::choice(const std::string& key, const std::vector<std::string>& names, std::size_t fallback) {
  const TomlValue* value = find(key);
  if (!value) return fallback;
  const std::string name = toText(*value, key);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return i;
  fail(*value, fmt::format("'{}' of {} cannot be '{}'{}", key, what_, name, suggestionOrList(name, names)));
}

std::string TomlReader::requiredText(const std::string& key) { return toText(require(key), key); }

const std::vector<TomlValue>& TomlReader::list(const std::string& key) {
  const TomlValue* value = find(key);
  if (!value) return noElements();
  if (value->kind != Kind::array) failType(*value, key, "a list");
  return value->elements;
}

std::vector<std::string> TomlReader::texts(const std::string& key) {
  const TomlValue* value = find(key);
  if (!value) return {};
  std::vector<std::string> result;
  const auto add = [&](const TomlValue& element) {
    if (element.kind != Kind::text) failType(element, key, "a string or a list of strings");
    if (element.text.empty()) fail(element, fmt::format("'{}' of {} contains an empty string", key, what_));
    result.push_back(element.text);
  };
  if (value->kind == Kind::array) {
    for (const TomlValue& element : value->elements) add(element);
    if (result.empty()) fail(*value, fmt::format("'{}' of {} is an empty list", key, what_));
  } else {
    add(*value);
  }
  return result;
}

const std::vector<TomlValue>& TomlReader::tables(const std::string& key) {
  const TomlValue* value = find(key);
  if (!value) return noElements();
  if (value->kind != Kind::array) fail(*value, fmt::format("'{}' must be written as [[{}]]", key, key));
  for (const TomlValue& element : value->elements)
    if (element.kind != Kind::table) fail(element, fmt::format("each '{}' must be a table", key));
  return value->elements;
}

const TomlValue* TomlReader::inlineTable(const std::string& key, std::string_view example) {
  const TomlValue* value = find(key);
  if (value && value->kind != Kind::table) fail(*value, fmt::format("'{}' must be a table such as {}", key, example));
  return value;
}

float TomlReader::toNumber(const TomlValue& value, std::string_view name, const NumberRange& range) const {
  constexpr double kLargest = std::numeric_limits<float>::max();
  const double real = std::clamp(value.real, -kLargest, kLargest);  // "no limit" can be any large number
  if (!value.isNumber() || !contains(range, real)) failType(value, name, "a number" + describe(range));
  return inside(range, normalFloat(real));
}

std::uint32_t TomlReader::toInteger(const TomlValue& value, std::string_view name, std::uint32_t low,
                                    std::uint32_t high) const {
  // 4.0 is accepted as 4.
  if (!value.isNumber() || value.real != std::floor(value.real) || value.real < low || value.real > high)
    failType(value, name, fmt::format("an integer from {} to {}", low, high));
  return static_cast<std::uint32_t>(value.real);
}

std::string TomlReader::toText(const TomlValue& value, std::string_view name) const {
  if (value.kind != Kind::text) failType(value, name, "a string");
  return value.text;
}

std::vector<float> TomlReader::toNumbers(const TomlValue& value, std::string_view name, std::size_t count,
                                         const NumberRange& range) const {
  if (value.kind != Kind::array || value.elements.size() != count)
    failType(value, name, fmt::format("a list of {} numbers", count));
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

vec3 TomlReader::toDirection(const TomlValue& value, std::string_view name) const {
  const glm::dvec3 v(toTriple(value, name));
  const double length = glm::length(v);
  if (!(length > 0.0)) failType(value, name, "a vector with a positive length");
  return vec3(v / length);
}

const TomlValue& TomlReader::toTable(const TomlValue& value, std::string_view name) const {
  if (value.kind != Kind::table) failType(value, name, "a table { ... }");
  return value;
}

void TomlReader::rejectUnknownKeys() const {
  for (const auto& [key, value] : table_.members) {
    if (known_.contains(key)) continue;
    fail(value, fmt::format("{} has no key '{}'{}", what_, key, suggestion(key, {known_.begin(), known_.end()})));
  }
}

}  // namespace quintet
