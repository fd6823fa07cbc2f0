// SPDX-License-Identifier: Apache-2.0
// debugPrintfEXT in programs: compiles the stages that print so that they store their arguments in the shader log, and
// keeps what the host needs for the text.
#ifndef QUINTET_PROGRAM_PRINT_H
#define QUINTET_PROGRAM_PRINT_H

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "program/compile.h"
#include "spirv/print_format.h"

namespace quintet::program {

// A call of debugPrintfEXT in the source of a stage.
struct PrintSite {
  SourceLocation location;  // in the stage's file or an included one
  std::string stage;        // file, as in CompiledProgram::Stage
  spirv::PrintFormat format;
};

// The calls of all stages by their numbers in the log.
using PrintTable = std::vector<PrintSite>;

// True if a stage calls debugPrintfEXT.
bool prints(const CompiledProgram& compiled);

// Replaces the stages of `compiled` that print by stages that store their prints in the log (kLogPrint). The other
// arguments are those of the compilation. Throws Error if spirv-opt fails, and ProgramError if a stage does not compile
// with the log or if a format is wrong, which the check reports earlier (Q707).
PrintTable enablePrints(CompiledProgram& compiled, const Program& program, const shader::Compiler& compiler,
                        const std::vector<std::pair<std::string, std::string>>& defines,
                        Instrumentation instrumentation);

}  // namespace quintet::program
#endif
