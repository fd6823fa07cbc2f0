// SPDX-License-Identifier: Apache-2.0
// Q667: the stack size that an application sets, compared with the longest chain of traces.
#ifndef QUINTET_CHECK_MODULES_STACK_CHECK_H
#define QUINTET_CHECK_MODULES_STACK_CHECK_H

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "base/diagnostic.h"

namespace quintet::check {

// A stage of the chain, in the order of the calls, with what vkGetRayTracingShaderGroupStackSizeKHR returns for it.
struct StackFrame {
  std::string stage;
  std::uint64_t bytes = 0;
};

// Nullopt if `size` is sufficient for the chain. The location of the diagnostic is unknown.
std::optional<Diagnostic> checkStackSize(std::uint64_t size, std::span<const StackFrame> chain);

}  // namespace quintet::check
#endif
