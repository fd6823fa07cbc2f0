// SPDX-License-Identifier: Apache-2.0
// Modules of SPV_EXT_shader_invocation_reorder with the instructions of SPV_NV_shader_invocation_reorder, which SPIRV-Tools 2023.1
// knows. What both extensions have differs only in its numbers.
#ifndef QUINTET_SPIRV_REORDER_CODE_H
#define QUINTET_SPIRV_REORDER_CODE_H

#include <cstdint>
#include <span>
#include <vector>

namespace quintet::spirv {

// True if the module declares the capability of SPV_EXT_shader_invocation_reorder.
bool usesReorderExt(std::span<const std::uint32_t> words);

// Returns a copy with instructions of the NV extension, without the time of motion blur. A combined instruction becomes its
// parts: a trace, and an execution. A hit object that is filled from a ray query, or whose record is set, becomes an empty one: the
// analyses do not follow what an execution of it runs. Words that cannot be read as instructions are copied.
std::vector<std::uint32_t> withReorderNv(std::span<const std::uint32_t> words);

}  // namespace quintet::spirv
#endif
