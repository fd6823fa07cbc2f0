// Values of parameters from JSON and to JSON.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "program/parameter.h"

namespace quintet::program {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxJsonBytes = std::size_t{1} << 24;

// As a message shows it.
std::string shown(const Json& value) {
  constexpr std::size_t kLongest = 60, kMostElements = 8;
  if (value.is_object()) return "{…}";
  // No deeper: writing is recursive.
  if (value.is_array() && (value.size() > kMostElements || std::ranges::any_of(value, &Json::is_structured)))
    return "[…]";
  const std::string text =
      value.is_string() ? value.get<std::string>() : value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() <= kLongest ? text : text.substr(0, kLongest) + "…";
}

// The numbers of a number, a bool or a list; nothing if there is something else in it. Too many are cut: they are
// wrong for every type.
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

// A key as a part of a JSON pointer (RFC 6901).
std::string pointer(const std::string& key) {
  std::string text = "/";
  for (const char c : key) text += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return text;
}

Json parse(const std::string& text, const std::string& file) {
  if (text.size() > kMaxJsonBytes)
    throw FileError(file, fmt::format("has {} bytes, more than the 16 MiB that values can have", text.size()));
  try {
    return Json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    throw FileError(file, fmt::format("byte {}", error.byte), "this is not JSON");
  } catch (const nlohmann::json::exception&) {
    throw FileError(file, "this is not JSON: a number is too large");
  }
}

}  // namespace

void ParameterValues::setFromJson(const std::string& json, const std::string& file) {
  const Json root = parse(json, file);
  if (!root.is_object())
    throw FileError(file, "the values of parameters are an object such as {\"tint\": [1, 0.5, 0]}");
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
      if (imageFiles_[i]) root[p.name] = *imageFiles_[i];  // the default image has no path outside the program
    } else if (p.type == ParameterType::choice) {
      root[p.name] = p.choices.at(static_cast<std::size_t>(values_[i][0]));
    } else {
      root[p.name] = values.size() == 1 ? values[0] : values;
    }
  }
  return root.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace quintet::program
