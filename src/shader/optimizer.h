// SPDX-License-Identifier: Apache-2.0
// The optimizations of shader::Compiler.
#ifndef QUINTET_SHADER_OPTIMIZER_H
#define QUINTET_SHADER_OPTIMIZER_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace quintet::shader {

// Increase it when `optimize` changes its results: it is part of the keys of the cache.
inline constexpr std::uint64_t kOptimizerVersion = 1;

// Validates `words`, reduces each function, and runs the performance passes of spirv-opt, which inline all functions.
// Without `debugInfo`, removes sources, lines and names. Throws Error if the module is invalid or a pass fails.
std::vector<std::uint32_t> optimize(const std::vector<std::uint32_t>& words, bool debugInfo = true);

// Values of specialization constants by constant_id: the bits, one word for up to 32 bits, else two.
using SpecializationValues = std::unordered_map<std::uint32_t, std::vector<std::uint32_t>>;

// Sets specialization constants of a module that `optimize` has made, and removes the code that becomes dead. The module is
// trusted. Throws Error if a pass fails.
std::vector<std::uint32_t> specialize(const std::vector<std::uint32_t>& words, const SpecializationValues& values);

// As `optimize`, for SPIR-V of unknown origin. With `values`, all specialization constants become constants: those that are
// missing there have their defaults. Without, they stay unknown. If a pass fails for a valid module, functions are only inlined.
std::vector<std::uint32_t> optimizeSpecialized(const std::vector<std::uint32_t>& words,
                                               const std::optional<SpecializationValues>& values);

// Validates `words`, reduces each function, and removes sources, lines and names: in a fifth of the time of `optimize`. What
// the module computes can differ from the optimized one in the last bits. Throws Error if the module is invalid or a pass
// fails.
std::vector<std::uint32_t> draft(const std::vector<std::uint32_t>& words);

// Only replaces variables by values and removes dead code, without validation.
std::vector<std::uint32_t> reduceUnvalidated(const std::vector<std::uint32_t>& words);

// Why SPIRV-Tools rejects a module.
struct ValidationProblem {
  std::string text;      // empty if the module is valid
  bool unknown = false;  // it uses a version, capability, extension or instruction that SPIRV-Tools does not know
  std::size_t instruction = 0;  // its number, from 1
};
ValidationProblem validate(const std::vector<std::uint32_t>& words);

}  // namespace quintet::shader
#endif
