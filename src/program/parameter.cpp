#include "program/parameter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include "base/error.h"

namespace quintet::program {
namespace {

bool isInteger(ParameterType type) { return type == ParameterType::boolean || type == ParameterType::integer; }

bool parseNumber(std::string_view text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

// Splits at commas; false if a part is not a number.
bool parseNumbers(std::string_view text, std::vector<double>& values) {
  while (true) {
    const std::size_t comma = text.find(',');
    double value = 0;
    if (!parseNumber(text.substr(0, comma), value)) return false;
    values.push_back(value);
    if (comma == std::string_view::npos) return true;
    text.remove_prefix(comma + 1);
  }
}

std::string formatValue(const Parameter& parameter, const ParameterValue& value) {
  if (parameter.type == ParameterType::boolean) return value[0] != 0 ? "true" : "false";
  std::string text;
  for (int i = 0; i < componentCount(parameter.type); ++i) text += fmt::format("{}{:g}", i ? "," : "", value[i]);
  return text;
}

}  // namespace

std::string_view typeName(ParameterType type) {
  constexpr std::string_view kNames[] = {"bool", "int", "float", "vec2", "vec3", "vec4", "color"};
  return kNames[static_cast<int>(type)];
}

std::string_view glslType(ParameterType type) {
  constexpr std::string_view kNames[] = {"uint", "int", "float", "vec2", "vec3", "vec4", "vec3"};
  return kNames[static_cast<int>(type)];
}

int componentCount(ParameterType type) {
  constexpr int kCounts[] = {1, 1, 1, 2, 3, 4, 3};
  return kCounts[static_cast<int>(type)];
}

ParameterValues::ParameterValues(const std::vector<Parameter>& parameters) : parameters_(parameters) {
  for (const Parameter& parameter : parameters) values_.push_back(parameter.defaultValue);
}

void ParameterValues::set(const std::string& name, const std::string& text) {
  const auto found = std::find_if(parameters_.begin(), parameters_.end(), [&](const Parameter& p) { return p.name == name; });
  if (found == parameters_.end()) {
    std::vector<std::string> names;
    for (const Parameter& parameter : parameters_) names.push_back(parameter.name);
    const std::string nearest = nearestName(name, names);
    throw UsageError(fmt::format("no parameter '{}'{}", name,
                                 nearest.empty() ? fmt::format("; there are: {}", fmt::join(names, ", "))
                                                 : fmt::format("; did you mean '{}'?", nearest)));
  }
  std::vector<double> numbers;
  const std::string value = text == "true" ? "1" : text == "false" ? "0" : text;
  const bool word = value != text;
  const auto count = static_cast<std::size_t>(componentCount(found->type));
  if ((word && found->type != ParameterType::boolean) || !parseNumbers(value, numbers) || numbers.size() != count ||
      (isInteger(found->type) && numbers[0] != std::floor(numbers[0])))
    throw UsageError(fmt::format("parameter '{}': '{}' is not a {}{}", name, text, typeName(found->type),
                                 count > 1 ? fmt::format(" ({} numbers with commas)", count) : ""));
  for (const double number : numbers) {
    if (number < found->min || number > found->max)
      throw UsageError(fmt::format("parameter '{}': {} is outside {} … {}", name, text, found->min, found->max));
  }
  ParameterValue& target = values_[static_cast<std::size_t>(found - parameters_.begin())];
  std::copy(numbers.begin(), numbers.end(), target.begin());
}

void ParameterValues::setAssignment(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw UsageError(fmt::format("'{}' is not of the form name=value", assignment));
  set(assignment.substr(0, equals), assignment.substr(equals + 1));
}

void ParameterValues::setAll(const std::vector<ParameterValue>& values) {
  assert(values.size() == parameters_.size());
  values_ = values;
}

const ParameterValue& ParameterValues::get(const std::string& name) const {
  for (std::size_t i = 0; i < parameters_.size(); ++i)
    if (parameters_[i].name == name) return values_[i];
  throw UsageError(fmt::format("no parameter '{}'", name));
}

std::vector<std::byte> ParameterValues::pack() const {
  std::vector<std::byte> bytes;
  const auto append = [&](const auto& word) {
    static_assert(sizeof(word) == 4);
    const auto* first = reinterpret_cast<const std::byte*>(&word);
    bytes.insert(bytes.end(), first, first + 4);
  };
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    for (int c = 0; c < componentCount(parameters_[i].type); ++c) {
      if (isInteger(parameters_[i].type)) append(static_cast<std::int32_t>(values_[i][c]));
      else append(static_cast<float>(values_[i][c]));
    }
  }
  if (bytes.empty()) bytes.resize(4);
  return bytes;
}

std::string ParameterValues::describe() const {
  std::string text;
  for (std::size_t i = 0; i < parameters_.size(); ++i)
    text += fmt::format("{}{}={}", i ? " " : "", parameters_[i].name, formatValue(parameters_[i], values_[i]));
  return text;
}

std::string nearestName(const std::string& name, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t bestDistance = std::max<std::size_t>(2, name.size() / 2);
  for (const std::string& candidate : candidates) {
    // Levenshtein's distance, one row at a time.
    std::vector<std::size_t> row(candidate.size() + 1);
    for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= name.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j < row.size(); ++j) {
        const std::size_t substituted = diagonal + (name[i - 1] != candidate[j - 1]);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
      }
    }
    if (row.back() <= bestDistance) {
      if (row.back() < bestDistance || best.empty()) best = candidate;
      bestDistance = row.back();
    }
  }
  return best;
}

}  // namespace quintet::program
