// Checks that only running can make: puts quintet/instrument.glsl around a stage's source. The renderer reads what the
// shaders wrote (render/instrument.h).
#ifndef QUINTET_PROGRAM_INSTRUMENT_H
#define QUINTET_PROGRAM_INSTRUMENT_H

#include <string>

#include "shader/compiler.h"

namespace quintet::program {

// The source of stage number `index` with the checks. Lines keep their numbers in messages. A lecture-form stage
// includes quintet/gsn.glsl, which brings the checks in at the right place itself; other sources get them behind their
// leading #version and #extension lines.
std::string instrumentStage(const std::string& source, shader::Stage stage, std::size_t index);

// Sources that instrumentation leaves as they are: no checks for intersection and callable shaders.
bool isInstrumented(shader::Stage stage);

}  // namespace quintet::program
#endif
