// SPDX-License-Identifier: Apache-2.0
#include "job/runnable_program.h"

#include <utility>

#include <fmt/format.h>

#include "check/check.h"

namespace quintet::job {

CheckedProgram checkCompiled(program::Program description, program::CompiledProgram compiled,
                             const program::SceneFacts& scene, const check::DeviceLimits& limits) {
  if (!compiled.ok) throw ProgramError(std::move(compiled.diagnostics));
  // Compiled for this scene: code for features that it lacks is missing, so unused stages are not reported.
  check::CheckResult checked = check::check(description, compiled, &scene, limits, true);
  if (!checked.ok()) throw ProgramError(std::move(checked.diagnostics));
  return {{std::move(description), std::move(compiled), checked.recursionDepth}, std::move(checked.diagnostics)};
}

CheckedProgram compileAndCheck(const program::Program& program, const shader::Compiler& compiler,
                               const render::Defines& defines, const program::SceneFacts& scene,
                               const check::DeviceLimits& limits, bool instrument) {
  return checkCompiled(program, program::compile(program, compiler, defines, instrument), scene, limits);
}

Diagnostic hangDiagnostic(const program::Program& program, double seconds) {
  return {Severity::error,
          program.path(program.rayGeneration),
          0,
          0,
          "HANG",
          fmt::format("a launch did not end within {:g} s, possibly because of an infinite loop in a shader", seconds)};
}

}  // namespace quintet::job
