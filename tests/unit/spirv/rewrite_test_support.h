// SPDX-License-Identifier: Apache-2.0
// Modules that a rewrite has changed: their validity, and their instructions.
#ifndef QUINTET_TESTS_UNIT_SPIRV_REWRITE_TEST_SUPPORT_H
#define QUINTET_TESTS_UNIT_SPIRV_REWRITE_TEST_SUPPORT_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <spirv-tools/libspirv.hpp>

#include "spirv/module.h"

namespace quintet::spirv {

using Words = std::vector<std::uint32_t>;

// Returns the messages of the validator; empty for a valid module.
inline std::string errorsOf(const Words& words) {
  std::string errors;
  spvtools::SpirvTools tools(SPV_ENV_VULKAN_1_3);
  tools.SetMessageConsumer(
      [&](spv_message_level_t, const char*, const spv_position_t&, const char* text) { errors += text; });
  spvtools::ValidatorOptions options;
  options.SetScalarBlockLayout(true);
  if (!tools.Validate(words.data(), words.size(), options) && errors.empty()) errors = "invalid";
  return errors;
}

inline std::size_t count(const Words& words, spv::Op op) {
  const auto module = Module::read(words);
  return static_cast<std::size_t>(std::ranges::count(module->instructions(), op, &Instruction::op));
}

}  // namespace quintet::spirv
#endif
