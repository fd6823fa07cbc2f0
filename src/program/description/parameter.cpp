// SPDX-License-Identifier: Apache-2.0
#include "program/description/parameter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/suggestion.h"

namespace quintet::program {
namespace {

struct TypeFacts {
  std::string_view name;
  std::string_view glsl;
  int components;
};

const TypeFacts& facts(ParameterType type) {
  static constexpr std::array<TypeFacts, kParameterTypeCount> kFacts{{{"bool", "uint", 1},
                                                                      {"int", "int", 1},
                                                                      {"float", "float", 1},
                                                                      {"vec2", "vec2", 2},
                                                                      {"vec3", "vec3", 3},
                                                                      {"vec4", "vec4", 4},
                                                                      {"color", "vec3", 3},
                                                                      {"uint", "uint", 1},
                                                                      {"choice", "uint", 1},
                                                                      {"image", "uint", 1}}};
  return kFacts[static_cast<std::size_t>(type)];
}

bool parseNumber(std::string_view text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

// Appends the numbers of a comma-separated list; returns false if a part is not a number.
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
  if (parameter.type == ParameterType::choice) return parameter.choices.at(static_cast<std::size_t>(value[0]));
  std::string text;
  for (std::size_t i = 0; i < static_cast<std::size_t>(componentCount(parameter.type)); ++i)
    text += isWhole(parameter.type) ? fmt::format("{}", static_cast<std::int64_t>(value[i]))
                                    : fmt::format("{}{}", i ? "," : "", value[i]);
  return text;
}

using Json = nlohmann::ordered_json;

// Returns a value as messages show it.
std::string shown(const Json& value) {
  constexpr std::size_t kLongest = 60, kMostElements = 8;
  if (value.is_object()) return "{…}";
  // Nested lists are not written, because dump() is recursive.
  if (value.is_array() && (value.size() > kMostElements || std::ranges::any_of(value, &Json::is_structured)))
    return "[…]";
  const std::string text =
      value.is_string() ? value.get<std::string>() : value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() <= kLongest ? text : text.substr(0, kLongest) + "…";
}

// Returns the numbers of a number, a bool or a list; empty if the value holds anything else or more than 5 numbers, which
// no type accepts.
std::optional<std::vector<double>> numbersOf(const Json& value, bool boolean) {
  if (boolean && value.is_boolean()) return std::vector<double>{value.get<bool>() ? 1.0 : 0.0};
  if (value.is_number()) return std::vector<double>{value.get<double>()};
  if (!value.is_array()) return {};
  std::vector<double> numbers;
  for (const Json& element : value) {
    if (!element.is_number() || numbers.size() == 5) return {};
    numbers.push_back(element.get<double>());
  }
  return numbers;
}

// Returns a key as a part of a JSON pointer (RFC 6901).
std::string pointer(const std::string& key) {
  std::string text = "/";
  for (const char c : key) text += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return text;
}

Json parseParameters(const std::string& text, const std::string& file) {
  try {
    return parseJson<Json>(file, text);
  } catch (const nlohmann::json::parse_error& error) {
    throw FileError(file, fmt::format("byte {}", error.byte), "invalid JSON");
  } catch (const nlohmann::json::exception&) {
    throw FileError(file, "invalid JSON: a number is too large");
  }
}

}  // namespace

std::string_view typeName(ParameterType type) { return facts(type).name; }
std::string_view glslType(ParameterType type) { return facts(type).glsl; }
int componentCount(ParameterType type) { return facts(type).components; }

bool isWhole(ParameterType type) {
  return type == ParameterType::boolean || type == ParameterType::integer || type == ParameterType::uinteger;
}

std::pair<double, double> typeRange(ParameterType type) {
  switch (type) {
    case ParameterType::boolean: return {0.0, 1.0};
    case ParameterType::integer: return {-2147483648.0, 2147483647.0};
    case ParameterType::uinteger: return {0.0, 4294967295.0};
    default: return {-1e30, 1e30};
  }
}

bool hasMin(const Parameter& parameter) { return parameter.min > typeRange(parameter.type).first; }
bool hasMax(const Parameter& parameter) { return parameter.max < typeRange(parameter.type).second; }

std::string formatDefault(const Parameter& parameter) {
  return parameter.type == ParameterType::image ? parameter.defaultImage
                                                : formatValue(parameter, parameter.defaultValue);
}

ParameterValues::ParameterValues(const std::vector<Parameter>& parameters)
    : parameters_(parameters), imageFiles_(parameters.size()) {
  for (const Parameter& parameter : parameters) values_.push_back(parameter.defaultValue);
}

std::size_t ParameterValues::indexOf(const std::string& name) const {
  const auto found =
      std::find_if(parameters_.begin(), parameters_.end(), [&](const Parameter& p) { return p.name == name; });
  if (found != parameters_.end()) return static_cast<std::size_t>(found - parameters_.begin());
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters_) names.push_back(parameter.name);
  throw UsageError(fmt::format("unknown parameter '{}'{}", name,
                               names.empty() ? ": the program has no parameters" : suggestionOrList(name, names)));
}

void ParameterValues::failType(std::size_t parameter, const std::string& shown) const {
  const Parameter& p = parameters_[parameter];
  const int count = componentCount(p.type);
  if (p.type == ParameterType::choice)
    throw UsageError(
        fmt::format("parameter '{}': unknown choice '{}'{}", p.name, shown, suggestionOrList(shown, p.choices)));
  if (p.type == ParameterType::image)
    throw UsageError(fmt::format("parameter '{}': '{}' is not the name of an image file", p.name, shown));
  throw UsageError(fmt::format("parameter '{}': '{}' is not {} {}{}", p.name, shown,
                               p.type == ParameterType::integer ? "an" : "a", typeName(p.type),
                               count > 1 ? fmt::format(" ({} numbers separated by commas)", count) : ""));
}

void ParameterValues::assign(std::size_t parameter, const std::vector<double>& numbers, const std::string& shown) {
  const Parameter& p = parameters_[parameter];
  if (p.type == ParameterType::choice || p.type == ParameterType::image ||
      numbers.size() != static_cast<std::size_t>(componentCount(p.type)) ||
      (isWhole(p.type) && numbers[0] != std::floor(numbers[0])))
    failType(parameter, shown);
  for (const double number : numbers)
    if (!(number >= p.min && number <= p.max))
      throw UsageError(fmt::format("parameter '{}': {} is out of range ({} to {})", p.name, shown, p.min, p.max));
  std::copy(numbers.begin(), numbers.end(), values_[parameter].begin());
}

void ParameterValues::assignText(std::size_t parameter, const std::string& text) {
  const Parameter& p = parameters_[parameter];
  if (p.type == ParameterType::image) {
    if (text.find('\0') != text.npos) failType(parameter, text);
    imageFiles_[parameter] = text;
    return;
  }
  const auto found = std::find(p.choices.begin(), p.choices.end(), text);
  if (p.type != ParameterType::choice || found == p.choices.end()) failType(parameter, text);
  values_[parameter][0] = static_cast<double>(found - p.choices.begin());
}

void ParameterValues::set(const std::string& name, const std::string& text) {
  const std::size_t parameter = indexOf(name);
  const ParameterType type = parameters_[parameter].type;
  if (type == ParameterType::image || type == ParameterType::choice) return assignText(parameter, text);
  std::vector<double> numbers;
  if (type == ParameterType::boolean && (text == "true" || text == "false"))
    numbers = {text == "true" ? 1.0 : 0.0};
  else if (!parseNumbers(text, numbers))
    failType(parameter, text);
  assign(parameter, numbers, text);
}

void ParameterValues::setAssignment(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw UsageError(fmt::format("'{}' must have the form name=value", assignment));
  set(assignment.substr(0, equals), assignment.substr(equals + 1));
}

void ParameterValues::setAll(const std::vector<ParameterValue>& values) {
  assert(values.size() == parameters_.size());
  values_ = values;
}

const ParameterValue& ParameterValues::get(const std::string& name) const { return values_[indexOf(name)]; }

std::vector<ImageValue> ParameterValues::images() const {
  std::vector<ImageValue> images;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const Parameter& p = parameters_[i];
    if (p.type != ParameterType::image) continue;
    const bool isDefault = !imageFiles_[i].has_value();
    images.push_back(
        {p.name, isDefault ? p.defaultImage : *imageFiles_[i], isDefault && !p.defaultImage.empty(), p.sRgb});
  }
  return images;
}

std::vector<std::byte> ParameterValues::pack(std::span<const std::uint32_t> textures) const {
  std::vector<std::byte> bytes;
  const auto append = [&](auto word) {
    static_assert(sizeof(word) == 4);
    const auto* first = reinterpret_cast<const std::byte*>(&word);
    bytes.insert(bytes.end(), first, first + 4);
  };
  std::size_t image = 0;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const ParameterType type = parameters_[i].type;
    if (type == ParameterType::image) {
      append(image < textures.size() ? textures[image] : kNoParameterTexture);
      ++image;
      continue;
    }
    for (std::size_t c = 0; c < static_cast<std::size_t>(componentCount(type)); ++c) {
      if (type == ParameterType::integer)
        append(static_cast<std::int32_t>(values_[i][c]));
      else if (glslType(type) == "uint")
        append(static_cast<std::uint32_t>(values_[i][c]));
      else
        append(static_cast<float>(values_[i][c]));
    }
  }
  if (bytes.empty()) bytes.resize(4);
  return bytes;
}

std::string ParameterValues::describe() const {
  std::string text;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const Parameter& p = parameters_[i];
    const std::string value =
        p.type == ParameterType::image ? imageFiles_[i].value_or(p.defaultImage) : formatValue(p, values_[i]);
    text += fmt::format("{}{}={}", i ? " " : "", p.name, value);
  }
  return text;
}

void ParameterValues::setFromJson(const std::string& json, const std::string& file) {
  const Json root = parseParameters(json, file);
  if (!root.is_object()) throw FileError(file, "parameter values must be an object such as {\"tint\": [1, 0.5, 0]}");
  ParameterValues values = *this;
  for (const auto& [name, value] : root.items()) {
    try {
      const std::size_t parameter = values.indexOf(name);
      const ParameterType type = values.parameters_[parameter].type;
      if (type == ParameterType::image || type == ParameterType::choice) {
        if (!value.is_string()) values.failType(parameter, shown(value));
        std::string text = value.get<std::string>();
        if (type == ParameterType::image && !text.empty() && text.find('\0') == text.npos)
          text = (std::filesystem::path(file).parent_path() / text).string();
        values.assignText(parameter, text);
      } else {
        const std::optional<std::vector<double>> numbers = numbersOf(value, type == ParameterType::boolean);
        if (!numbers) values.failType(parameter, shown(value));
        values.assign(parameter, *numbers, shown(value));
      }
    } catch (const UsageError& error) {
      throw FileError(file, pointer(name), error.what());
    }
  }
  *this = std::move(values);
}

std::string ParameterValues::toJson() const {
  Json root = Json::object();
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const Parameter& p = parameters_[i];
    Json values = Json::array();
    const auto number = [&](double value) {
      return p.type == ParameterType::boolean ? Json(value != 0)
             : isWhole(p.type)                ? Json(static_cast<std::int64_t>(value))
                                              : Json(value);
    };
    for (std::size_t c = 0; c < static_cast<std::size_t>(componentCount(p.type)); ++c)
      values.push_back(number(values_[i][c]));
    if (p.type == ParameterType::image) {
      if (imageFiles_[i]) root[p.name] = *imageFiles_[i];  // the default image is a file of the program
    } else if (p.type == ParameterType::choice) {
      root[p.name] = p.choices.at(static_cast<std::size_t>(values_[i][0]));
    } else {
      root[p.name] = values.size() == 1 ? values[0] : values;
    }
  }
  return root.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace quintet::program
