// SPDX-License-Identifier: Apache-2.0
// Modules of newer compilers and extensions in a form that SPIRV-Tools and the analyses know, without a change of which shaders
// run and what they share. Traces of VK_NV_ray_tracing_motion_blur become plain traces: the time of a ray does not select a
// shader. Hit objects become those of the NV extension (reorder_code.h). VK_NV_ray_tracing cannot be expressed as plain traces.
#ifndef QUINTET_SPIRV_PLAIN_CODE_H
#define QUINTET_SPIRV_PLAIN_CODE_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "spirv/module.h"

namespace quintet::spirv {

// Returns a copy with OpTraceRayKHR in place of OpTraceRayMotionNV, with hit objects of SPV_NV_shader_invocation_reorder, without DontInline, which would hide the accesses of a
// function from the analysis, with decorations in place of decoration groups, loads and stores in place of OpCopyMemory, and with
// OpSource of an unknown language for languages that are newer than SPIRV-Tools. Words that cannot be read as instructions are
// copied.
std::vector<std::uint32_t> withPlainCode(std::span<const std::uint32_t> given);

// Returns a copy without instruction `number` (from 1), if the analyses do not need it: a capability, an extension, a
// decoration, an execution mode or a source. Nullopt for other instructions.
std::optional<std::vector<std::uint32_t>> withoutDeclaration(std::span<const std::uint32_t> words, std::size_t number);

// Returns a copy without the declarations of extensions that not all passes of SPIRV-Tools know, because such passes leave the
// module unchanged. Nullopt if there are none.
std::optional<std::vector<std::uint32_t>> withoutNewExtensions(std::span<const std::uint32_t> words);

// The name of an instruction of the module that runs other shaders and that StageFacts does not follow; empty if there is none.
std::string_view otherTrace(const Module& module);

}  // namespace quintet::spirv
#endif
