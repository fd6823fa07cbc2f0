// SPDX-License-Identifier: Apache-2.0
// Instruments shaders with checks at run time: wraps quintet/instrument.glsl or quintet/recursion.glsl around the source of
// a stage. The renderer reads what the shaders wrote (render/renderer/instrument.h).
#ifndef QUINTET_PROGRAM_INSTRUMENT_H
#define QUINTET_PROGRAM_INSTRUMENT_H

#include <string>

#include "shader/compiler.h"

namespace quintet::program {

enum class Instrumentation {
  none,
  recursion,  // traces beyond the recursion depth of the pipeline are skipped and counted
  checks,     // all checks of quintet/instrument.glsl, which include that one
};

// Returns the source of stage number `index` with the checks. Those of the recursion are only in stages that can trace.
// Messages keep their line numbers. A lecture-form stage includes quintet/gsn.glsl, which includes the checks itself;
// other sources get them after their leading #version and #extension lines.
std::string instrumentStage(const std::string& source, shader::Stage stage, std::size_t index,
                            Instrumentation instrumentation = Instrumentation::checks);

}  // namespace quintet::program
#endif
