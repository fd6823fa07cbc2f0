// SPDX-License-Identifier: Apache-2.0
// Instrumented variants of a compiled program that compute the same image and also record data: what shaders print
// (debugPrintfEXT), and heat maps. The stages are compiled without optimization, changed as SPIR-V, and then optimized.
#ifndef QUINTET_PROGRAM_PROBES_H
#define QUINTET_PROGRAM_PROBES_H

#include <string>
#include <utility>
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

// Replaces stages of `compiled` by variants with these probes: stages that print store their prints in the shader log
// (kLogPrint), and all stages that rays reach count for heat maps (quintet/heat.glsl). The other arguments are those of the
// compilation. Throws Error if spirv-opt fails, and ProgramError if a stage does not compile with the probes or if a format
// is wrong, which the check reports earlier (Q707).
PrintTable addProbes(CompiledProgram& compiled, const Program& program, const shader::Compiler& compiler,
                     const std::vector<std::pair<std::string, std::string>>& defines, Instrumentation instrumentation,
                     Probes probes);

// An operation whose result can be the first value that is not finite.
struct ValueSite {
  SourceLocation location;  // in the stage's file or an included one
  std::string stage;        // file, as in CompiledProgram::Stage
  std::string operation;    // "division", "sqrt"
};

// Replaces all stages of `compiled` by variants that store in the shader log (kLogValue) which operations have a result that
// is not finite, in the order in which they are executed. Returns the operations by their numbers in the log. The other
// arguments, and the errors, are those of addProbes(). The variants of large programs take long to compile.
std::vector<ValueSite> addValueProbes(CompiledProgram& compiled, const Program& program,
                                      const shader::Compiler& compiler,
                                      const std::vector<std::pair<std::string, std::string>>& defines,
                                      Instrumentation instrumentation);

}  // namespace quintet::program
#endif
