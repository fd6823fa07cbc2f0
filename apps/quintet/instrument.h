// A small picture with checks in the shaders, for `quintet check --instrument`.
#ifndef QUINTET_APP_INSTRUMENT_H
#define QUINTET_APP_INSTRUMENT_H

#include <string>
#include <vector>

#include "program/program.h"
#include "scene/scene.h"
#include "shader/compiler.h"

namespace quintet::app {

// Renders 96 x 64 pixels, one batch or two frames, and returns what the checks found (docs/diagnostics, Q001 … Q006).
// A launch that hangs ends the process after 20 s (hang.h). Throws what gpu and render throw.
std::vector<shader::Diagnostic> runInstrumented(const program::Program& program, const scene::Scene& scene,
                                                const shader::Compiler& compiler, const std::string& device);

}  // namespace quintet::app
#endif
