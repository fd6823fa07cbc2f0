#include "program_report.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "program/program_json.h"

namespace quintet::app {
namespace {

using Json = nlohmann::ordered_json;

std::string describe(const program::Parameter& parameter) {
  const bool white = parameter.type == program::ParameterType::image && parameter.defaultImage.empty();
  const std::string value = white ? "white" : program::formatDefault(parameter);
  std::string range;
  if (program::hasMin(parameter)) range += fmt::format(", at least {}", parameter.min);
  if (program::hasMax(parameter)) range += fmt::format(", at most {}", parameter.max);
  if (!parameter.choices.empty()) range = fmt::format(", one of {}", fmt::join(parameter.choices, ", "));
  const std::string unit = parameter.unit.empty() ? "" : " " + parameter.unit;
  return fmt::format("  {:<18}{}\n{:20}{}, default {}{}{}\n", parameter.name, parameter.help, "",
                     program::typeName(parameter.type), value, unit, range);
}

// At most a line of it.
std::string firstSentence(const std::string& text) {
  constexpr std::size_t kMost = 90;
  const std::string sentence = text.substr(0, text.find(". "));
  if (sentence.size() <= kMost) return sentence;
  const std::size_t space = sentence.rfind(' ', kMost);
  return sentence.substr(0, space == sentence.npos ? kMost : space) + " ...";
}

std::string oneLine(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace

std::string programHelp(const program::Program& program) {
  std::string text = fmt::format("{}: {}\n\n", program.name, program.description);
  if (program.accumulation == program::Accumulation::program) text += "Draws frame after frame: --frames N.\n\n";
  text += "Parameters (--set NAME=VALUE):\n";
  if (program.parameters.empty()) text += "  none\n";
  for (const program::Parameter& parameter : program.parameters) text += describe(parameter);
  text += "\nOutputs (--output NAME, --all-outputs, --aov NAMES):\n";
  for (const program::Output& output : program.outputs)
    text += fmt::format("  {:<18}{}\n", output.name,
                        output.help.empty() ? std::string(program::outputKindName(output.kind)) : output.help);
  return text + "\n'quintet run --help' lists the options that every program has.\n";
}

std::string programJson(const program::Program& program) { return program::describeAsJson(program) + "\n"; }

std::string programList(bool json) {
  Json list = Json::array();
  std::string text;
  std::size_t width = 0;
  for (const std::string& name : program::builtInPrograms()) width = std::max(width, name.size());
  for (const std::string& name : program::builtInPrograms()) {
    const program::Program program = program::loadProgram(name);
    text += fmt::format("{:<{}}  {}\n", name, width, firstSentence(program.description));
    list.push_back({{"name", name}, {"description", program.description}});
  }
  return json ? oneLine(list) : text;
}

}  // namespace quintet::app
