// SPDX-License-Identifier: Apache-2.0
// Compiles and checks a program for one scene and one device, so that a renderer can run it.
#ifndef QUINTET_JOB_RUNNABLE_PROGRAM_H
#define QUINTET_JOB_RUNNABLE_PROGRAM_H

#include <vector>

#include <quintet/device.h>

#include "base/diagnostic.h"
#include "check/device_limits.h"
#include "gpu/device_info.h"
#include "job/request.h"
#include "program/probes.h"
#include "program/runnable_program.h"
#include "program/scene_facts.h"
#include "render/scene/scene_features.h"

namespace quintet::job {

struct CheckedProgram {
  program::RunnableProgram runnable;
  std::vector<Diagnostic> diagnostics;  // warnings and notes of the compiler and of the check
  bool cyclic = false;                  // check::CheckResult::cyclic
};

// Checks `compiled`, which is `description` compiled for this scene. Throws ProgramError.
CheckedProgram checkCompiled(program::Program description, program::CompiledProgram compiled,
                             const program::SceneFacts& scene, const check::DeviceLimits& limits);

// If the traces of the program form a cycle, nothing proves that their depth stays within that of the pipeline: compiles
// the stages again so that they count it and skip deeper traces, whose number Renderer::skippedTraces() returns.
// `defines` are those of the first compilation. Throws ProgramError.
void countRecursion(CheckedProgram& checked, const shader::Compiler& compiler, const render::Defines& defines);

// Returns the probes that the request requires of the program. Throws UsageError if the device cannot measure time for a heat
// map.
program::Probes requestedProbes(const RenderRequest& request, const program::Program& program,
                                const gpu::DeviceInfo& device);

// Replaces stages by variants with these probes (program/probes.h). After countRecursion(), with the same `defines`. Throws
// ProgramError.
program::PrintTable addProbes(CheckedProgram& checked, const shader::Compiler& compiler, const render::Defines& defines,
                              program::Probes probes);

// Replaces all stages by variants that log which values are not finite (program/probes.h). After countRecursion(), with the
// same `defines`. Throws ProgramError.
std::vector<program::ValueSite> addValueProbes(CheckedProgram& checked, const shader::Compiler& compiler,
                                               const render::Defines& defines);

// `defines` are those of render::renderDefines. The result has Instrumentation::checks or explain on request; without
// checks, the program counts its recursion if necessary. Throws ProgramError.
CheckedProgram compileAndCheck(const program::Program& program, const shader::Compiler& compiler,
                               const render::Defines& defines, const program::SceneFacts& scene,
                               const check::DeviceLimits& limits,
                               program::Instrumentation instrumentation = program::Instrumentation::none);

// Returns what Observer::deviceHung() reports when a launch of the program did not end in time.
Diagnostic hangDiagnostic(const program::Program& program, const TimeoutError& error);

}  // namespace quintet::job
#endif
