// SPDX-License-Identifier: Apache-2.0
// Data flow of a module: what a value depends on, and what depends on it, through SSA values and local variables. The
// order of stores is ignored: a load of a local variable depends on every store to it.
#ifndef QUINTET_SPIRV_VALUE_FLOW_H
#define QUINTET_SPIRV_VALUE_FLOW_H

#include <functional>
#include <optional>
#include <vector>

#include "spirv/module.h"

namespace quintet::spirv {

using InstructionTest = std::function<bool(const Instruction&)>;

// Returns the first instruction for which `test` holds among those that compute `value`, including its own: operands,
// stores to the local variables that are loaded, results of called functions, and arguments of the function whose
// parameter it is. The search does not follow the operands of an instruction for which `stop` holds. Null if not found.
const Instruction* findInSlice(const Module& module, Id value, const InstructionTest& test,
                               const InstructionTest& stop = {});

// The union of the slices of several values: each instruction is tested once, so that the searches for all values take as
// long as one.
class Slices {
 public:
  // `module` must exist as long as this object.
  explicit Slices(const Module& module) : module_(&module), seen_(module.instructions().size(), false) {}
  // As findInSlice(), without the instructions that an earlier search has visited.
  const Instruction* find(Id value, const InstructionTest& test, const InstructionTest& stop = {});

 private:
  const Module* module_;
  std::vector<bool> seen_;
};

inline bool dependsOn(const Module& module, Id value, const InstructionTest& test, const InstructionTest& stop = {}) {
  return findInSlice(module, value, test, stop) != nullptr;
}

// Returns a test for reads of what `value` is computed from: the variables that are loaded (all buffers count as one) and
// the phis. Null if it is computed from constants alone.
InstructionTest sourcesOf(const Module& module, Id value);

// Returns the first instruction for which `test` holds among those that use `value`, directly or through other values
// and local variables. The search does not follow the users of an instruction for which `stop` holds. Null if not
// found.
const Instruction* findInUses(const Module& module, Id value, const InstructionTest& test,
                              const InstructionTest& stop = {});

// Returns the built-in of which the instruction loads a part or all; nullopt if it loads none.
std::optional<spv::BuiltIn> loadedBuiltIn(const Module& module, const Instruction& instruction);
bool loadsBuiltIn(const Module& module, const Instruction& instruction, spv::BuiltIn builtIn);
bool loadsBuiltIn(const Module& module, Id value, spv::BuiltIn builtIn);

// True for the GLSL.std.450 instruction with this number, e.g. GLSLstd450Normalize.
bool isExtended(const Module& module, const Instruction& instruction, std::uint32_t number);

// True if `later` can run after `earlier` in one invocation. In a loop, each can run after the other.
bool canRunAfter(const Module& module, std::size_t later, std::size_t earlier);

// True for variables with storage class Function or Private.
bool isLocal(const Module& module, Id variable);

// Returns the values that a load of a local variable can see: those of all stores that overlap with the loaded part.
// Returns nullopt if the variable is passed to a function or copied.
std::optional<std::vector<Id>> storedValues(const Module& module, const Instruction& load);

}  // namespace quintet::spirv
#endif
