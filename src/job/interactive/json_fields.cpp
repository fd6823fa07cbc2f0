// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/json_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/suggestion.h"

namespace quintet::job::interactive {
namespace {

using nlohmann::json;

[[noreturn]] void fail(const std::string& name, const std::string& problem) {
  throw UsageError(fmt::format("'{}' {}", name, problem));
}

double toNumber(const std::string& name, const json& value) {
  if (!value.is_number()) fail(name, "must be a number");
  const auto number = value.get<double>();
  if (std::abs(number) > std::numeric_limits<float>::max()) fail(name, "is out of range");
  return number;
}

std::vector<double> toNumbers(const std::string& name, const json& value) {
  if (value.is_boolean()) return {value.get<bool>() ? 1.0 : 0.0};
  if (!value.is_array()) return {toNumber(name, value)};
  std::vector<double> numbers;
  for (const json& element : value) numbers.push_back(toNumber(name, element));
  return numbers;
}

}  // namespace

JsonFields::JsonFields(std::string_view text) {
  try {
    object_ = parseJson(text);
  } catch (const json::parse_error& error) {
    throw UsageError(fmt::format("byte {}: invalid JSON", error.byte));
  } catch (const json::out_of_range&) {
    throw UsageError("a number is out of range");
  }
  if (!object_.is_object()) throw UsageError("a command must be a JSON object");
}

const json* JsonFields::find(const std::string& name) {
  known_.push_back(name);
  const auto found = object_.find(name);
  return found == object_.end() ? nullptr : &*found;
}

const json& JsonFields::require(const std::string& name) {
  const json* value = find(name);
  if (value) return *value;
  rejectOthers();  // a misspelled name explains more
  fail(name, "is missing");
}

bool JsonFields::has(const std::string& name) { return find(name) != nullptr; }

std::string JsonFields::text(const std::string& name) {
  const json& value = require(name);
  if (!value.is_string()) fail(name, "must be a text");
  return value.get<std::string>();
}

std::optional<std::string> JsonFields::findText(const std::string& name) {
  return has(name) ? std::optional(text(name)) : std::nullopt;
}

double JsonFields::number(const std::string& name) { return toNumber(name, require(name)); }

std::optional<double> JsonFields::findNumber(const std::string& name) {
  const json* value = find(name);
  return value ? std::optional(toNumber(name, *value)) : std::nullopt;
}

std::optional<bool> JsonFields::findFlag(const std::string& name) {
  const json* value = find(name);
  if (!value) return std::nullopt;
  if (!value->is_boolean()) fail(name, "must be true or false");
  return value->get<bool>();
}

float JsonFields::real(const std::string& name, float otherwise) {
  const std::optional<double> value = findNumber(name);
  return value ? static_cast<float>(*value) : otherwise;
}

std::uint32_t JsonFields::whole(const std::string& name, double min) {
  constexpr double kMax = 1u << 24;
  const double value = number(name);
  if (!(value >= min && value <= kMax) || value != std::floor(value))
    fail(name, fmt::format("must be a whole number from {} to {}", min, kMax));
  return static_cast<std::uint32_t>(value);
}

std::uint32_t JsonFields::count(const std::string& name) { return whole(name, 1); }

std::uint32_t JsonFields::index(const std::string& name) { return whole(name, 0); }

std::vector<double> JsonFields::numbers(const std::string& name, std::size_t count) {
  std::vector<double> values = toNumbers(name, require(name));
  if (values.size() != count) fail(name, fmt::format("must be a list of {} numbers", count));
  return values;
}

std::optional<vec3> JsonFields::findPoint(const std::string& name) {
  if (!has(name)) return std::nullopt;
  const std::vector<double> values = numbers(name, 3);
  return vec3(values[0], values[1], values[2]);
}

std::string JsonFields::assignedValue(const std::string& name) {
  const json& value = require(name);
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number() || value.is_boolean()) return value.dump();
  if (!value.is_array()) fail(name, "must be a number, true, false, a text, or a list of numbers");
  std::string text;
  for (const json& element : value) {
    toNumber(name, element);
    text += (text.empty() ? "" : ",") + element.dump();
  }
  return text;
}

std::vector<std::pair<std::string, std::vector<double>>> JsonFields::otherNumbers() {
  std::vector<std::pair<std::string, std::vector<double>>> others;
  for (const auto& [name, value] : object_.items())
    if (std::ranges::find(known_, name) == known_.end()) others.emplace_back(name, toNumbers(name, value));
  for (const auto& [name, numbers] : others) known_.push_back(name);
  return others;
}

void JsonFields::rejectOthers() const {
  for (const auto& [name, value] : object_.items())
    if (std::ranges::find(known_, name) == known_.end())
      throw UsageError(fmt::format("unknown key '{}'{}", name, suggestionOrList(name, known_)));
}

}  // namespace quintet::job::interactive
