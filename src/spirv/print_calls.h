// SPDX-License-Identifier: Apache-2.0
// The calls of debugPrintfEXT in a module, and their replacement by calls of functions that store the arguments
// (quintet/print.glsl).
#ifndef QUINTET_SPIRV_PRINT_CALLS_H
#define QUINTET_SPIRV_PRINT_CALLS_H

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "spirv/module.h"
#include "spirv/print_format.h"

namespace quintet::spirv {

struct PrintCall {
  std::size_t instruction = 0;  // index in Module::instructions()
  std::string format;
  std::vector<PrintArgument> arguments;
};

// True if the module can have such calls. Much faster than reading the module.
bool importsDebugPrintf(std::span<const std::uint32_t> words);

// In the order of the module. Functions that are called from several locations have one call until they are inlined.
std::vector<PrintCall> findPrintCalls(const Module& module);

// Replaces call k of findPrintCalls() by calls of the module's functions printBegin_ and printWord_, with the number
// firstNumber + k and one word per PrintArgument::wordCount(). Removes the call of printKeep_, whose purpose is that the
// compiler keeps the functions. The module must not be optimized, or these functions are missing. All arguments can be
// printed (PrintFormat). Throws Error if the module cannot be read or does not have the functions.
std::vector<std::uint32_t> replacePrintCalls(const std::vector<std::uint32_t>& words, std::uint32_t firstNumber);

}  // namespace quintet::spirv
#endif
