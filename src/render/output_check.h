// Diagnostic Q002: values of a film that are not finite, and samples that the program itself has left out.
#ifndef QUINTET_RENDER_OUTPUT_CHECK_H
#define QUINTET_RENDER_OUTPUT_CHECK_H

#include <vector>

#include "program/program.h"
#include "render/film.h"
#include "shader/diagnostics.h"

namespace quintet::render {

// Adds them to `result`. Blocks.
void checkOutputs(const program::Program& program, const Film& film, std::vector<shader::Diagnostic>& result);

}  // namespace quintet::render
#endif
