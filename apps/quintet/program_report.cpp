#include "program_report.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace quintet::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNoLimit = 1e30;

bool isBoolean(const program::Parameter& parameter) { return parameter.type == program::ParameterType::boolean; }
bool isWhole(const program::Parameter& parameter) {
  return parameter.type == program::ParameterType::integer;
}
bool hasMin(const program::Parameter& p) { return !isBoolean(p) && p.min > (isWhole(p) ? -2147483648.0 : -kNoLimit); }
bool hasMax(const program::Parameter& p) { return !isBoolean(p) && p.max < (isWhole(p) ? 2147483647.0 : kNoLimit); }

std::string describe(const program::Parameter& parameter) {
  std::string value;
  for (int i = 0; i < program::componentCount(parameter.type); ++i)
    value += fmt::format("{}{}", i > 0 ? "," : "", parameter.defaultValue[static_cast<std::size_t>(i)]);
  if (isBoolean(parameter)) value = parameter.defaultValue[0] != 0 ? "true" : "false";
  std::string range;
  if (hasMin(parameter)) range += fmt::format(", at least {}", parameter.min);
  if (hasMax(parameter)) range += fmt::format(", at most {}", parameter.max);
  const std::string unit = parameter.unit.empty() ? "" : " " + parameter.unit;
  return fmt::format("  {:<18}{}\n{:20}{}, default {}{}{}\n", parameter.name, parameter.help, "",
                     program::typeName(parameter.type), value, unit, range);
}

Json number(const program::Parameter& parameter, double value) {
  if (isBoolean(parameter)) return value != 0;
  if (isWhole(parameter)) return static_cast<std::int64_t>(value);
  return value;
}

Json toJson(const program::Parameter& parameter) {
  Json json{{"name", parameter.name}, {"type", program::typeName(parameter.type)}};
  const int count = program::componentCount(parameter.type);
  Json values = Json::array();
  for (int i = 0; i < count; ++i) values.push_back(number(parameter, parameter.defaultValue[static_cast<std::size_t>(i)]));
  json["default"] = count == 1 ? values[0] : values;
  json["min"] = hasMin(parameter) ? number(parameter, parameter.min) : Json();
  json["max"] = hasMax(parameter) ? number(parameter, parameter.max) : Json();
  json["unit"] = parameter.unit;
  json["help"] = parameter.help;
  return json;
}

std::string_view accumulationName(const program::Program& program) {
  return program.accumulation == program::Accumulation::program ? "program" : "film";
}

Json toJson(const program::Program& program) {
  Json parameters = Json::array();
  for (const program::Parameter& parameter : program.parameters) parameters.push_back(toJson(parameter));
  Json outputs = Json::array();
  for (const program::Output& output : program.outputs)
    outputs.push_back({{"name", output.name}, {"kind", program::outputKindName(output.kind)}, {"help", output.help}});
  return {{"name", program.name},
          {"description", program.description},
          {"accumulation", accumulationName(program)},
          {"parameters", parameters},
          {"outputs", outputs}};
}

std::string oneLine(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace

std::string programHelp(const program::Program& program) {
  std::string text = fmt::format("{}: {}\n\n", program.name, program.description);
  if (program.accumulation == program::Accumulation::program) text += "Draws frame after frame: --frames N.\n\n";
  text += "Parameters (--set NAME=VALUE):\n";
  if (program.parameters.empty()) text += "  none\n";
  for (const program::Parameter& parameter : program.parameters) text += describe(parameter);
  text += "\nOutputs (--output NAME, --all-outputs):\n";
  for (const program::Output& output : program.outputs)
    text += fmt::format("  {:<18}{}\n", output.name,
                        output.help.empty() ? std::string(program::outputKindName(output.kind)) : output.help);
  return text + "\n'quintet run --help' lists the options that every program has.\n";
}

std::string programJson(const program::Program& program) { return oneLine(toJson(program)); }

std::string programList(bool json) {
  Json list = Json::array();
  std::string text;
  std::size_t width = 0;
  for (const std::string& name : program::builtInPrograms()) width = std::max(width, name.size());
  for (const std::string& name : program::builtInPrograms()) {
    const program::Program program = program::loadProgram(name);
    text += fmt::format("{:<{}}  {}\n", name, width, program.description);
    list.push_back({{"name", name}, {"description", program.description}});
  }
  return json ? oneLine(list) : text;
}

}  // namespace quintet::app
