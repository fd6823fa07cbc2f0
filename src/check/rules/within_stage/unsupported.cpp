// SPDX-License-Identifier: Apache-2.0
// Instructions that compile but that Quintet does not support.
#include "check/rules/rules.h"
#include "spirv/module.h"

namespace quintet::check {

void checkDebugPrintf(const spirv::Module& module, Report& report) {
  for (const spirv::Instruction& i : module.instructions())
    if (i.op == spv::Op::OpExtInst && module.extendedSet(i.at(0)) == "NonSemantic.DebugPrintf")
      report.addOncePerLine("Q707", module.location(i, "debugPrintfEXT"),
                            "debugPrintfEXT is not supported: its text would not be printed");
}

}  // namespace quintet::check
