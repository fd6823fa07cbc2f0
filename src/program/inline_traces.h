// SPDX-License-Identifier: Apache-2.0
// Traces by ray queries instead of calls of hit and miss shaders (shaders/quintet/ray_query.glsl), on devices where such calls are
// slow. This changes no result, so it requires that the shaders of the program are those that the ray queries stand for.
#ifndef QUINTET_PROGRAM_INLINE_TRACES_H
#define QUINTET_PROGRAM_INLINE_TRACES_H

#include <string>
#include <utility>
#include <vector>

#include "program/description/program.h"
#include "program/instrument.h"

namespace quintet::program {

// Defined by the renderer if the device and the scene permit ray queries. Stages of programs that do not are compiled without it.
constexpr const char* kInlineTraces = "QUINTET_INLINE_TRACES";

// Returns `defines`, without kInlineTraces if this program must call its shaders: it has shaders of its own for triangles or rays
// that miss, or instrumentation that observes calls.
std::vector<std::pair<std::string, std::string>> withTraces(const Program& program,
                                                            std::vector<std::pair<std::string, std::string>> defines,
                                                            Instrumentation instrumentation);

}  // namespace quintet::program
#endif
