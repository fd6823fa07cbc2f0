// What a value depends on, and what depends on it: through SSA form and through local variables. Without regard to
// the order of stores: a load of a local variable depends on every store into it.
#ifndef QUINTET_SHADER_SPIRV_FLOW_H
#define QUINTET_SHADER_SPIRV_FLOW_H

#include <functional>

#include "shader/spirv_module.h"

namespace quintet::shader {

using InstructionTest = std::function<bool(const SpirvInstruction&)>;

// The first instruction for which `test` holds among those that compute `value` (its own included): operands,
// stores into the local variables that are loaded, results of functions that are called and arguments of the
// function it is a parameter of. Where `stop` holds, the search does not go on to the operands. Null: none.
const SpirvInstruction* findInSlice(const SpirvModule& module, SpirvId value, const InstructionTest& test,
                                    const InstructionTest& stop = {});

inline bool dependsOn(const SpirvModule& module, SpirvId value, const InstructionTest& test,
                      const InstructionTest& stop = {}) {
  return findInSlice(module, value, test, stop) != nullptr;
}

// The first instruction for which `test` holds among those that use `value`, directly or through other values and
// local variables. Where `stop` holds, the search does not go on to the users. Null: none.
const SpirvInstruction* findInUses(const SpirvModule& module, SpirvId value, const InstructionTest& test,
                                   const InstructionTest& stop = {});

// Does the instruction load a built-in (any part of it)?
bool loadsBuiltIn(const SpirvModule& module, const SpirvInstruction& instruction, spv::BuiltIn builtIn);

// Is it the instruction of GLSL.std.450 with this number (GLSLstd450Normalize is 69)?
bool isExtended(const SpirvModule& module, const SpirvInstruction& instruction, std::uint32_t number);

// Can `later` run after `earlier`, in one invocation? In a loop, both may run after each other.
bool mayRunAfter(const SpirvModule& module, std::size_t later, std::size_t earlier);

}  // namespace quintet::shader
#endif
