// SPDX-License-Identifier: Apache-2.0
// Replaces NonSemantic.Shader.DebugInfo.100 by OpLine and OpSource, which spirv-opt keeps. Its passes fail for some modules
// with the extended instructions.
#ifndef QUINTET_SPIRV_PLAIN_LINES_H
#define QUINTET_SPIRV_PLAIN_LINES_H

#include <cstdint>
#include <span>
#include <vector>

namespace quintet::spirv {

// Returns a copy with the lines of instructions, functions and variables at module scope, and with the sources. Words that
// cannot be read as instructions, and modules without these instructions, are copied.
std::vector<std::uint32_t> withPlainLines(std::span<const std::uint32_t> words);

}  // namespace quintet::spirv
#endif
