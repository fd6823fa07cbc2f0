// The values that a load of a local variable can see: those of every store into the same part of it, in any order.
#ifndef QUINTET_PROGRAM_STORED_VALUES_H
#define QUINTET_PROGRAM_STORED_VALUES_H

#include <optional>
#include <vector>

#include "shader/spirv_module.h"

namespace quintet::program {

// Is it a variable of the function, or a global one of the invocation?
bool isLocal(const shader::SpirvModule& module, shader::SpirvId variable);

// Empty: not known, as the variable is handed to a function or copied.
std::optional<std::vector<shader::SpirvId>> storedValues(const shader::SpirvModule& module,
                                                         const shader::SpirvInstruction& load);

}  // namespace quintet::program
#endif
