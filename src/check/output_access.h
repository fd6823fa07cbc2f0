// SPDX-License-Identifier: Apache-2.0
// Outputs of a program in SPIR-V. A shader finds an output's sums by its address in Frame::outputs
// (shaders/quintet/shared/frame.h).
#ifndef QUINTET_CHECK_OUTPUT_ACCESS_H
#define QUINTET_CHECK_OUTPUT_ACCESS_H

#include <cstdint>

#include "spirv/module.h"

namespace quintet::check {

enum class OutputTarget {
  none,     // no buffer reference, or another buffer
  output,   // the output with the number OutputAccess::slot
  unknown,  // possibly an output
};
struct OutputAccess {
  OutputTarget target = OutputTarget::none;
  std::uint32_t slot = 0;
};

// Returns what a pointer points to: OutputArray(frame.outputs[slot]).at[...].
OutputAccess outputOf(const spirv::Module& module, spirv::Id pointer);

}  // namespace quintet::check
#endif
