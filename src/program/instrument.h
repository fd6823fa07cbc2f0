// SPDX-License-Identifier: Apache-2.0
// Instruments shaders: wraps quintet/instrument.glsl or quintet/recursion.glsl, which check at run time, or
// quintet/explain.glsl, quintet/print.glsl and quintet/heat.glsl, around the source of a stage. The renderer reads what the
// shaders wrote (render/renderer/instrument.h, render/renderer/shader_log.h).
#ifndef QUINTET_PROGRAM_INSTRUMENT_H
#define QUINTET_PROGRAM_INSTRUMENT_H

#include <string>

#include "shader/compiler.h"

namespace quintet::program {

enum class Instrumentation {
  none,
  recursion,  // traces beyond the recursion depth of the pipeline are skipped and counted
  checks,     // all checks of quintet/instrument.glsl, which include that one
  // Logs what each stage does (quintet/explain.glsl), and counts the recursion if QUINTET_RECURSION_DEPTH is defined.
  explain,
};

// Returns the source of stage number `index` with the instrumentation. Only stages that can trace get the recursion check.
// Messages keep their line numbers. A lecture-form stage includes quintet/gsn.glsl, which includes it itself;
// other sources get them after their leading #version and #extension lines.
// `usesLibrary`: the stage includes <quintet/…> itself. Otherwise it can declare the names of the library for its own use.
std::string instrumentStage(const std::string& source, shader::Stage stage, std::size_t index,
                            Instrumentation instrumentation = Instrumentation::checks, bool usesLibrary = true);

// What an instrumented variant of a stage records (program/probes.h).
struct Probes {
  bool prints = false;
  bool heat = false;    // counts for heat maps
  bool values = false;  // operations whose result is not finite
};

// Returns the source of a stage with the functions of quintet/print.glsl, quintet/heat.glsl and
// quintet/values.glsl, for spirv::replacePrintCalls, spirv::addTraceCalls and spirv::addValueChecks. `source` can have the checks of the recursion, but not all checks.
// `accumulates`: the program averages its own frames. `usesLibrary` as above.
std::string probedStage(const std::string& source, shader::Stage stage, Probes probes, bool accumulates,
                        bool usesLibrary = true);

}  // namespace quintet::program
#endif
