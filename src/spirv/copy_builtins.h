// SPDX-License-Identifier: Apache-2.0
// Workaround for drivers on which a nested trace overwrites the built-ins of the outer hit (Mesa's lavapipe 25.0.7;
// docs/design/quirks.md): copies them at the start of main and uses the copies after traces.
#ifndef QUINTET_SPIRV_COPY_BUILTINS_H
#define QUINTET_SPIRV_COPY_BUILTINS_H

#include "spirv/module.h"

namespace quintet::spirv {

// True for the built-ins that a nested trace overwrites: primitive, instance, custom and geometry index, hit kind,
// object-to-world and world-to-object matrix.
bool isOverwrittenByTrace(spv::BuiltIn builtIn);

// True if copyBuiltIns can replace this load: it is in the entry function and its indices are constant.
bool canCopyBuiltIn(const Module& module, std::size_t load);

// Returns the module with copies in place of all such loads that can run after a trace. Returns the words unchanged if
// there are no such loads or if the module cannot be read. Lines and names are kept.
std::vector<std::uint32_t> copyBuiltIns(std::vector<std::uint32_t> words);

}  // namespace quintet::spirv
#endif
