#include "program_setup.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"

namespace quintet::app {
program::ParameterValues parameterValues(const program::Program& program, const RenderOptions& options) {
  program::ParameterValues values(program.parameters);
  if (!options.setFile.empty()) values.setFromJson(readTextFile(options.setFile), options.setFile);
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
