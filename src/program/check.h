// The check of the linked pipeline: program x scene x device. Vulkan validates each shader alone; this joins them and
// says, with file and line, what does not fit together. Ids and words: diagnostic_catalog.h, docs/diagnostics/.
#ifndef QUINTET_PROGRAM_CHECK_H
#define QUINTET_PROGRAM_CHECK_H

#include "program/device_limits.h"
#include "program/link.h"
#include "program/scene_facts.h"

namespace quintet::program {

struct CheckResult {
  std::vector<shader::Diagnostic> diagnostics;  // the compiler's first, then the link's by id
  // Depth of nested traces that the pipeline needs: the longest chain over the table, or the declared bound where
  // traces form a cycle.
  std::uint32_t recursionDepth = 1;
  // Payloads, callable data and hit attributes along the worst chain; the least that the stack must hold. What a
  // driver adds for registers, only the driver knows (rt::Pipeline).
  std::uint64_t stackBytes = 0;
  std::vector<std::string> reached;  // files of the stages that can run
  double seconds = 0;                // wall clock, compilation included
  bool ok() const;                   // no error
};

// `compiled`: made with a compiler with CompilerOptions::debugInfo, else the diagnostics have no lines, and with
// `optimize`, else nothing is a constant. `scene`: null for any scene. `featureDefines`: the shaders were compiled for
// one scene (QUINTET_NO_...), so that code may be missing; what nobody reaches is then not reported.
CheckResult check(const Program& program, const CompiledProgram& compiled, const SceneFacts* scene,
                  const DeviceLimits& limits, bool featureDefines = false);

// Compiles first; if that fails, the compiler's diagnostics are the result.
CheckResult check(const Program& program, const shader::Compiler& compiler, const SceneFacts* scene,
                  const DeviceLimits& limits, const std::vector<std::pair<std::string, std::string>>& defines = {});

}  // namespace quintet::program
#endif
