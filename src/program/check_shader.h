// Mistakes that one compiled stage shows by its data flow: Q701 to Q705 (directions, normals, indices, origins) and
// Q901, Q902, Q904, Q905 (defects of drivers). What joins several stages is in check.h.
//
// Every rule prefers silence to a false alarm: where a value cannot be followed, nothing is reported. What each rule
// follows, and where it gives up, is written in docs/design/check.md.
#ifndef QUINTET_PROGRAM_CHECK_SHADER_H
#define QUINTET_PROGRAM_CHECK_SHADER_H

#include <vector>

#include "gpu/context.h"
#include "shader/compiler.h"
#include "shader/spirv_module.h"

namespace quintet::program {

struct ShaderSituation {
  bool keepsInstanceOrder = false;  // Program::keepsInstanceOrder: gl_InstanceID is the scene's index
  bool hasAnyHit = false;           // an intersection shader: one of its hit groups has an any-hit shader
  gpu::Quirks quirks;               // of the device; default: one without defects
};

// `module`: compiled with `optimize` and `debugInfo`.
std::vector<shader::Diagnostic> checkShader(const shader::SpirvModule& module, const ShaderSituation& situation);

}  // namespace quintet::program
#endif
