// SPDX-License-Identifier: Apache-2.0
#include "job/runnable_program.h"

#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "check/check.h"
#include "program/heat.h"
#include "program/hit_shaders.h"

namespace quintet::job {
namespace {

// Replaces the stages of a program by those with `instrumentation`.
void instrument(program::RunnableProgram& runnable, const shader::Compiler& compiler, const render::Defines& defines,
                program::Instrumentation instrumentation) {
  program::CompiledProgram compiled = program::compile(runnable.description, compiler, defines, instrumentation);
  if (!compiled.ok) throw ProgramError(std::move(compiled.diagnostics));
  compiled.seconds += runnable.compiled.seconds;
  runnable.compiled = std::move(compiled);
}

// With the definitions of quintet/recursion.glsl.
render::Defines recursionDefines(const program::RunnableProgram& runnable, render::Defines defines) {
  defines.emplace_back("QUINTET_RECURSION_DEPTH", fmt::format("{}u", runnable.recursionDepth));
  return defines;
}

}  // namespace

CheckedProgram checkCompiled(program::Program description, program::CompiledProgram compiled,
                             const program::SceneFacts& scene, const check::DeviceLimits& limits) {
  if (!compiled.ok) throw ProgramError(std::move(compiled.diagnostics));
  // Compiled for this scene: code for features that it lacks is missing, so unused stages are not reported.
  check::CheckResult checked = check::check(description, compiled, &scene, limits, true);
  if (!checked.ok()) throw ProgramError(std::move(checked.diagnostics));
  return {{std::move(description), std::move(compiled), checked.recursionDepth, false},
          std::move(checked.diagnostics),
          checked.cyclic};
}

void countRecursion(CheckedProgram& checked, const shader::Compiler& compiler, const render::Defines& defines) {
  if (!checked.cyclic) return;
  program::RunnableProgram& runnable = checked.runnable;
  instrument(runnable, compiler, recursionDefines(runnable, defines), program::Instrumentation::recursion);
  runnable.countsRecursion = true;
}

program::Probes requestedProbes(const RenderRequest& request, const program::Program& program,
                                const gpu::DeviceInfo& device) {
  program::Probes probes;
  probes.prints = request.print.has_value();
  probes.heat = program::hasHeatMap(program, request.outputs);
  const bool measuresTime = program::hasHeatMap(program, request.outputs, program::kHeatTime);
  if (measuresTime && device.software)
    throw UsageError(fmt::format(
        "output '{}': not available on {}, because the clock of shaders on a CPU also counts the time in which "
        "other threads run; use heat_rays or heat_bounces, or a GPU",
        program::kHeatTime, device.name));
  if (measuresTime && !device.shaderClock)
    throw UsageError(
        fmt::format("output '{}': {} has no clock for shaders (VK_KHR_shader_clock)", program::kHeatTime, device.name));
  return probes;
}

program::PrintTable addProbes(CheckedProgram& checked, const shader::Compiler& compiler, const render::Defines& defines,
                              program::Probes probes) {
  program::RunnableProgram& runnable = checked.runnable;
  const bool counts = runnable.countsRecursion;
  runnable.countsHeat = probes.heat;
  return program::addProbes(runnable.compiled, runnable.description, compiler,
                            counts ? recursionDefines(runnable, defines) : defines,
                            counts ? program::Instrumentation::recursion : program::Instrumentation::none, probes);
}

std::vector<program::ValueSite> addValueProbes(CheckedProgram& checked, const shader::Compiler& compiler,
                                               const render::Defines& defines) {
  program::RunnableProgram& runnable = checked.runnable;
  const bool counts = runnable.countsRecursion;
  return program::addValueProbes(runnable.compiled, runnable.description, compiler,
                                 counts ? recursionDefines(runnable, defines) : defines,
                                 counts ? program::Instrumentation::recursion : program::Instrumentation::none);
}

CheckedProgram compileAndCheck(const program::Program& program, const shader::Compiler& compiler,
                               const render::Defines& defines, const program::SceneFacts& scene,
                               const check::DeviceLimits& limits, program::Instrumentation instrumentation) {
  using program::Instrumentation;
  CheckedProgram checked = checkCompiled(program, program::compile(program, compiler, defines), scene, limits);
  program::RunnableProgram& runnable = checked.runnable;
  if (instrumentation != Instrumentation::checks && instrumentation != Instrumentation::explain) {
    countRecursion(checked, compiler, defines);
    return checked;
  }
  runnable.description = program::withHitShaders(std::move(runnable.description), instrumentation);
  runnable.countsRecursion = checked.cyclic && instrumentation == Instrumentation::explain;
  instrument(runnable, compiler, runnable.countsRecursion ? recursionDefines(runnable, defines) : defines,
             instrumentation);
  return checked;
}

Diagnostic hangDiagnostic(const program::Program& program, const TimeoutError& error) {
  return {
      Severity::error,
      program.path(program.rayGeneration),
      0,
      0,
      "HANG",
      fmt::format("{} did not end within {:g} s, without the time of compilation; possibly because of an infinite loop "
                  "in a shader",
                  error.work().empty() ? "a launch" : error.work(), error.seconds())};
}

}  // namespace quintet::job
