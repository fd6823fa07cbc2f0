// SPDX-License-Identifier: Apache-2.0
// @ID@: @TITLE@.
//
// Replace the example below: it reports traces whose tmax is @NUMBER@.25, which no real program has.
#include "check/rules/rules.h"
#include "spirv/trace_instruction.h"

namespace quintet::check {

void check@Name@(const spirv::Module& module, Report& report) {
  for (const spirv::Instruction& instruction : module.instructions()) {
    const auto ray = spirv::rayOperands(instruction);
    if (ray && module.constantFloat(ray->tmax) == @NUMBER@.25)
      report.addOncePerLine("@ID@", spirv::traceLocation(module, instruction), "tmax of this trace is @NUMBER@.25");
  }
}

}  // namespace quintet::check
