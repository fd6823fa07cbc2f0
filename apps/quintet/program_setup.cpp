#include "program_setup.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"

namespace quintet::app {
namespace {

// "0.5,1,0" of [0.5, 1, 0]; numbers in the shortest form that reads back the same.
std::string valueText(const nlohmann::json& value, const std::filesystem::path& file, const std::string& name) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean() || value.is_number()) return value.dump();
  std::string text;
  bool good = value.is_array() && !value.empty();
  for (std::size_t i = 0; good && i < value.size(); ++i) {
    good = value[i].is_number();
    text += (i > 0 ? "," : "") + value[i].dump();
  }
  if (!good) throw FileError(file, "/" + name, "is not a number, true, false, a text, or a list of numbers");
  return text;
}

void setFromFile(program::ParameterValues& values, const std::filesystem::path& file) {
  nlohmann::json json;
  try {
    json = nlohmann::json::parse(readTextFile(file));
  } catch (const nlohmann::json::parse_error& error) {
    throw FileError(file, fmt::format("byte {}", error.byte), "is not JSON");
  }
  if (!json.is_object()) throw FileError(file, "is not a JSON object of parameters");
  for (const auto& [name, value] : json.items()) {
    try {
      values.set(name, valueText(value, file, name));
    } catch (const UsageError& error) {
      throw FileError(file, error.what());
    }
  }
}

}  // namespace

program::ParameterValues parameterValues(const program::Program& program, const RenderOptions& options) {
  program::ParameterValues values(program.parameters);
  if (!options.setFile.empty()) setFromFile(values, options.setFile);
  for (const std::string& assignment : options.assignments) values.setAssignment(assignment);
  for (const auto& [name, value] : {std::pair<std::string, std::optional<std::string>>{"bounces", options.bounces},
                                    std::pair<std::string, std::optional<std::string>>{"clamp", options.clamp}}) {
    if (!value) continue;
    if (std::ranges::find(program.parameters, name, &program::Parameter::name) == program.parameters.end())
      throw UsageError(fmt::format("--{}: the program '{}' has no parameter '{}'", name, program.name, name));
    values.set(name, *value);
  }
  return values;
}

render::ToneMap chooseToneMap(const program::Output& output, const RenderOptions& options) {
  if (options.toneMap) return *options.toneMap;
  return output.kind == program::OutputKind::color ? render::ToneMap::neutral : render::ToneMap::linear;
}

}  // namespace quintet::app
