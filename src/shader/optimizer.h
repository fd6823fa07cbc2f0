// SPDX-License-Identifier: Apache-2.0
// The optimizations that shader::Compiler makes, for modules that were changed after a compilation without them
// (Source::optimize).
#ifndef QUINTET_SHADER_OPTIMIZER_H
#define QUINTET_SHADER_OPTIMIZER_H

#include <cstdint>
#include <vector>

namespace quintet::shader {

// Runs the performance passes of spirv-opt. Throws Error if they fail.
std::vector<std::uint32_t> optimize(const std::vector<std::uint32_t>& words);

}  // namespace quintet::shader
#endif
