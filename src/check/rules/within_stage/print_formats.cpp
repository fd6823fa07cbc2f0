// SPDX-License-Identifier: Apache-2.0
// Formats of debugPrintfEXT that are invalid or do not match their arguments.
#include "base/error.h"
#include "check/rules/rules.h"
#include "spirv/module.h"
#include "spirv/print_calls.h"

namespace quintet::check {

void checkPrintFormats(const spirv::Module& module, Report& report) {
  for (const spirv::PrintCall& call : spirv::findPrintCalls(module)) {
    try {
      const spirv::PrintFormat format(call.format, call.arguments);
    } catch (const Error& error) {
      report.addOncePerLine("Q707", module.location(module.instructions()[call.instruction], "debugPrintfEXT"),
                            error.what());
    }
  }
}

}  // namespace quintet::check
