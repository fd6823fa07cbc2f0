// SPDX-License-Identifier: Apache-2.0
// The check of the linked pipeline: program, scene and device together. Vulkan validates each shader alone; the check
// connects them and reports mismatches with file and line. Ids and texts: catalog.h, docs/diagnostics.
#ifndef QUINTET_CHECK_CHECK_H
#define QUINTET_CHECK_CHECK_H

#include <span>

#include "check/device_limits.h"
#include "check/pipeline_graph.h"
#include "check/suppression.h"
#include "program/compile.h"
#include "program/scene_facts.h"

namespace quintet::spirv {
class Module;
}

namespace quintet::check {

struct StageContext;
struct ProgramStageContext;

struct CheckResult {
  std::vector<Diagnostic> diagnostics;           // of the compiler, then of the rules by id
  std::vector<SuppressedDiagnostic> suppressed;  // that comments in the sources accept (check/suppression.h)
  // Depth of nested traces that the pipeline needs: the longest chain of traces, or the declared bound if traces form a
  // cycle.
  std::uint32_t recursionDepth = 1;
  // Bytes of payloads, callable data and hit attributes along the worst chain: a lower bound of the stack size. Only
  // the driver knows what it adds for registers (rt::Pipeline).
  std::uint64_t stackBytes = 0;
  // Traces form a cycle, so the depth depends on values: runs count it (program::Instrumentation::recursion).
  bool cyclic = false;
  std::vector<std::string> reached;          // files of the reachable stages
  std::vector<std::string> chain;            // of raw modules: stages along the longest chain of traces
  std::vector<std::filesystem::path> files;  // read from disk in addition to Program::files
  double seconds = 0;                        // wall time, including compilation
  bool ok() const { return !hasErrors(diagnostics); }
};

// Checks compiled stages. They must be compiled with `debugInfo`, or diagnostics have no lines, and with `optimize`, or
// arguments are not constant. A null `scene` stands for any scene. `featureDefines` says that the shaders were compiled
// for one scene (QUINTET_NO_…), so code can be missing: unreachable stages and unused suppressions are then not reported.
CheckResult check(const program::Program& program, const program::CompiledProgram& compiled,
                  const program::SceneFacts* scene, const DeviceLimits& limits, bool featureDefines = false);

// Compiles and checks. If compilation fails, the result has the diagnostics of the compiler.
CheckResult check(const program::Program& program, const shader::Compiler& compiler, const program::SceneFacts* scene,
                  const DeviceLimits& limits, const std::vector<std::pair<std::string, std::string>>& defines = {});

// As above, with the default outputs and once more with all optional outputs, so that the code of each of them is
// checked (#ifdef QUINTET_OUTPUT_…). What only the second check finds names the optional output in its text. If it is not
// found with a single output, it names all of them.
CheckResult checkWithOptionalOutputs(const program::Program& program, const shader::Compiler& compiler,
                                     const program::SceneFacts* scene, const DeviceLimits& limits);

// Checks raw modules with the rules that hold for every pipeline (rules/rules.h). A stage that cannot be analyzed, or that
// has a problem, is not reported here; the rules that need all stages are then left out. Locations without a line name the
// module, and the text names the SPIR-V id. `mergesEqual`: equal traces and stages are followed once (pipelines with thousands
// of hit groups); without it, the same diagnostics take quadratic time.
CheckResult checkModules(PipelineGroups groups, std::span<const ModuleStage> modules, const DeviceLimits& limits,
                         bool mergesEqual = true);

// Runs the rules within one stage that hold for every pipeline.
std::vector<Diagnostic> checkStage(const spirv::Module& module, const StageContext& context);
// Runs those that depend on Quintet's library, its optimizer or its order of instances.
std::vector<Diagnostic> checkProgramStage(const spirv::Module& module, const ProgramStageContext& context);

}  // namespace quintet::check
#endif
