// SPDX-License-Identifier: Apache-2.0
// Instruments shaders with checks at run time: wraps quintet/instrument.glsl around the source of a stage. The renderer
// reads what the shaders wrote (render/renderer/instrument.h).
#ifndef QUINTET_PROGRAM_INSTRUMENT_H
#define QUINTET_PROGRAM_INSTRUMENT_H

#include <string>

#include "shader/compiler.h"

namespace quintet::program {

// Returns the source of stage number `index` with the checks; intersection and callable shaders have none. Messages keep
// their line numbers. A lecture-form stage includes quintet/gsn.glsl, which includes the checks itself; other sources get
// them after their leading #version and #extension lines.
std::string instrumentStage(const std::string& source, shader::Stage stage, std::size_t index);

}  // namespace quintet::program
#endif
