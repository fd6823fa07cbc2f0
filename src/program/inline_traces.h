// SPDX-License-Identifier: Apache-2.0
// Traces by ray queries instead of calls of hit and miss shaders (shaders/quintet/ray_query.glsl), on devices where such calls are
// slow. Images stay the same, so only programs that use the library's hit and miss shaders can use ray queries. Programs of users
// always call their shaders: the check derives what happens at calls from the same modules that the device gets.
#ifndef QUINTET_PROGRAM_INLINE_TRACES_H
#define QUINTET_PROGRAM_INLINE_TRACES_H

#include <string>
#include <utility>
#include <vector>

#include "program/description/program.h"
#include "program/instrument.h"

namespace quintet::program {

// The renderer defines it if the device and the scene permit ray queries. definesOfStages() removes it for other programs.
constexpr const char* kInlineTraces = "QUINTET_INLINE_TRACES";

// Returns the definitions without kInlineTraces.
std::vector<std::pair<std::string, std::string>> withoutInlineTraces(
    std::vector<std::pair<std::string, std::string>> defines);

// Returns `defines`, without kInlineTraces if the stages must call shaders: the program is not built in or has hit or miss shaders
// of its own, or the instrumentation observes calls.
std::vector<std::pair<std::string, std::string>> definesOfStages(
    const Program& program, std::vector<std::pair<std::string, std::string>> defines, Instrumentation instrumentation);

}  // namespace quintet::program
#endif
