// SPDX-License-Identifier: Apache-2.0
#include "program/help.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/wrap.h"
#include "program/load.h"

namespace quintet::program {
namespace {

using Json = nlohmann::ordered_json;

Json numberJson(ParameterType type, double value) {
  if (type == ParameterType::boolean) return value != 0;
  if (isWhole(type)) return static_cast<std::int64_t>(value);
  return value;
}

Json defaultJson(const Parameter& parameter) {
  if (parameter.type == ParameterType::image || parameter.type == ParameterType::choice)
    return formatDefault(parameter);
  Json values = Json::array();
  for (std::size_t i = 0; i < static_cast<std::size_t>(componentCount(parameter.type)); ++i)
    values.push_back(numberJson(parameter.type, parameter.defaultValue[i]));
  return values.size() == 1 ? values[0] : values;
}

Json parameterJson(const Parameter& parameter) {
  Json json{{"name", parameter.name}, {"type", typeName(parameter.type)}, {"default", defaultJson(parameter)}};
  if (parameter.type == ParameterType::choice) {
    json["choices"] = parameter.choices;
  } else if (parameter.type == ParameterType::image) {
    json["encoding"] = parameter.sRgb ? "srgb" : "linear";
  } else {
    json["min"] = hasMin(parameter) ? numberJson(parameter.type, parameter.min) : Json();
    json["max"] = hasMax(parameter) ? numberJson(parameter.type, parameter.max) : Json();
  }
  json["unit"] = parameter.unit;
  json["help"] = parameter.help;
  return json;
}

std::string oneLine(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string parameterFacts(const Parameter& parameter) {
  const bool white = parameter.type == ParameterType::image && parameter.defaultImage.empty();
  const std::string value = white ? "white" : formatDefault(parameter);
  std::string range;
  if (hasMin(parameter)) range += fmt::format(", at least {}", parameter.min);
  if (hasMax(parameter)) range += fmt::format(", at most {}", parameter.max);
  if (!parameter.choices.empty()) range = fmt::format(", one of {}", fmt::join(parameter.choices, ", "));
  const std::string unit = parameter.unit.empty() ? "" : " " + parameter.unit;
  return fmt::format("{}, default {}{}{}", typeName(parameter.type), value, unit, range);
}

std::string firstSentence(const std::string& text) { return text.substr(0, text.find(". ")); }

// Column of the help texts.
std::size_t helpColumn(const Program& program) {
  std::size_t longest = 16;
  for (const Parameter& parameter : program.parameters) longest = std::max(longest, columnsOf(parameter.name));
  for (const Output& output : program.outputs) longest = std::max(longest, columnsOf(output.name));
  return longest + 4;
}

}  // namespace

std::string describeAsText(const Program& program, std::size_t width) {
  const std::size_t column = helpColumn(program);
  std::string text = twoColumns("", program.name + ": " + program.description, 0, width) + "\n";
  if (program.accumulation == Accumulation::program) text += "Renders frame by frame.\n\n";
  text += "Parameters:\n";
  if (program.parameters.empty()) text += "  none\n";
  for (const Parameter& parameter : program.parameters) {
    text += twoColumns("  " + parameter.name, parameter.help, column, width);
    text += twoColumns("", parameterFacts(parameter), column, width);
  }
  text += "\nOutputs:\n";
  for (const Output& output : program.outputs)
    text += twoColumns("  " + output.name, output.help.empty() ? std::string(outputKindName(output.kind)) : output.help,
                       column, width);
  return text;
}

std::string describeAsJson(const Program& program) {
  Json rays = Json::array(), outputs = Json::array(), parameters = Json::array();
  for (const RayType& ray : program.rays) rays.push_back(ray.name);
  for (const Output& output : program.outputs)
    outputs.push_back({{"name", output.name},
                       {"kind", outputKindName(output.kind)},
                       {"pixel", outputPixelName(output.pixel)},
                       {"optional", output.optional},
                       {"channels", outputChannels(output)},
                       {"help", output.help}});
  for (const Parameter& parameter : program.parameters) parameters.push_back(parameterJson(parameter));
  const Json json{{"name", program.name},
                  {"description", program.description},
                  {"accumulation", program.accumulation == Accumulation::program ? "program" : "film"},
                  {"rays", rays},
                  {"parameters", parameters},
                  {"outputs", outputs}};
  return oneLine(json);
}

std::string listAsText(std::size_t width) {
  const std::vector<std::string> names = builtInPrograms();
  std::size_t longest = 0;
  for (const std::string& name : names) longest = std::max(longest, name.size());
  std::string text;
  for (const std::string& name : names)
    text += twoColumns(name, firstSentence(loadProgram(name).description), longest + 2, width);
  return text;
}

std::string listAsJson() {
  Json list = Json::array();
  for (const std::string& name : builtInPrograms())
    list.push_back({{"name", name}, {"description", loadProgram(name).description}});
  return oneLine(list);
}

}  // namespace quintet::program
