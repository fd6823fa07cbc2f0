// A mend for drivers on which the built-ins of a hit change during a nested trace (Mesa's lavapipe 25.0.7; docs/design/
// quirks.md): loads them once, at the start of main, and uses these values from then on.
#ifndef QUINTET_SHADER_MEND_BUILTINS_H
#define QUINTET_SHADER_MEND_BUILTINS_H

#include "shader/spirv_module.h"

namespace quintet::shader {

// Is it one of those that change: primitive, instance, custom and geometry index, hit kind, object and world matrix?
bool changesInNestedTrace(spv::BuiltIn builtIn);

// Can mendNestedBuiltIns replace this load? Not in a function that was not inlined, nor with an index that is computed.
bool canMendLoad(const SpirvModule& module, std::size_t load);

// The module with every such load replaced that can run after a trace. Unchanged if there is none, or if the words are
// no module that can be read. Lines and names stay.
std::vector<std::uint32_t> mendNestedBuiltIns(std::vector<std::uint32_t> words);

}  // namespace quintet::shader
#endif
