#include "program_setup.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"

namespace quintet::app {
namespace {

constexpr double kNoLimit = 1e30;

std::string describe(const program::Parameter& parameter) {
  std::string value;
  for (int i = 0; i < program::componentCount(parameter.type); ++i)
    value += fmt::format("{}{}", i > 0 ? "," : "", parameter.defaultValue[static_cast<std::size_t>(i)]);
  if (parameter.type == program::ParameterType::boolean) value = parameter.defaultValue[0] != 0 ? "true" : "false";
  std::string range;
  if (parameter.min > -kNoLimit && parameter.type != program::ParameterType::boolean)
    range += fmt::format(", at least {}", parameter.min);
  if (parameter.max < kNoLimit && parameter.type != program::ParameterType::boolean)
    range += fmt::format(", at most {}", parameter.max);
  const std::string unit = parameter.unit.empty() ? "" : " " + parameter.unit;
  return fmt::format("  {:<18}{}\n{:20}{}, default {}{}{}\n", parameter.name, parameter.help, "",
                     program::typeName(parameter.type), value, unit, range);
}

}  // namespace

program::ParameterValues parameterValues(const program::Program& program, const RenderOptions& options) {
  program::ParameterValues values(program.parameters);
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

std::string programHelp(const program::Program& program) {
  std::string text = fmt::format("{}: {}\n\nParameters (--set NAME=VALUE):\n", program.name, program.description);
  if (program.parameters.empty()) text += "  none\n";
  for (const program::Parameter& parameter : program.parameters) text += describe(parameter);
  text += "\nOutputs:\n";
  for (const program::Output& output : program.outputs)
    text += fmt::format("  {:<18}{}\n", output.name, output.help.empty() ? std::string(program::outputKindName(output.kind)) : output.help);
  return text;
}

render::ToneMap chooseToneMap(const program::Program& program, const RenderOptions& options) {
  if (options.toneMap) return *options.toneMap;
  const bool isColor = !program.outputs.empty() && program.outputs.front().kind == program::OutputKind::color;
  return isColor ? render::ToneMap::neutral : render::ToneMap::linear;
}

}  // namespace quintet::app
