// SPDX-License-Identifier: Apache-2.0
#include "check/modules/stack_check.h"

#include <fmt/format.h>

#include "check/catalog.h"

namespace quintet::check {

std::optional<Diagnostic> checkStackSize(std::uint64_t size, std::span<const StackFrame> chain) {
  std::uint64_t needed = 0;
  std::string text;
  for (const StackFrame& frame : chain) {
    needed += frame.bytes;
    text += fmt::format("{}{} ({} bytes)", text.empty() ? "" : " -> ", frame.stage, frame.bytes);
  }
  if (size >= needed) return {};
  Diagnostic d;
  d.id = "Q667";
  d.severity = findDiagnostic(d.id)->severity;
  d.text = fmt::format("the stack size is set to {} bytes, but this chain of traces needs at least {}: {}", size,
                       needed, text);
  return d;
}

}  // namespace quintet::check
