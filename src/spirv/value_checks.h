// SPDX-License-Identifier: Apache-2.0
// Adds to a module calls that check the results of floating-point operations (quintet/values.glsl), to find the first one
// that is not finite.
#ifndef QUINTET_SPIRV_VALUE_CHECKS_H
#define QUINTET_SPIRV_VALUE_CHECKS_H

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "spirv/module.h"

namespace quintet::spirv {

// An operation whose result can be the first one that is not finite: arithmetic, functions such as sqrt, and reads of buffers
// and images. Results are 32-bit floats or vectors of them.
struct CheckedValue {
  std::size_t instruction = 0;  // index in Module::instructions()
  std::string_view operation;   // for a message: "division", "sqrt", "a read of an image"
};

// In the order of the module.
std::vector<CheckedValue> findCheckedValues(const Module& module);

// After operation k of findCheckedValues(), calls the module's function valueResult1_, … or valueResult4_ with the number
// firstNumber + k, the result and its operands. Removes the call of valuesKeep_, whose purpose is that the compiler keeps the
// functions. The module must not be optimized, or these functions are missing. Throws Error if the module cannot be read or
// does not have the functions.
std::vector<std::uint32_t> addValueChecks(const std::vector<std::uint32_t>& words, std::uint32_t firstNumber);

}  // namespace quintet::spirv
#endif
