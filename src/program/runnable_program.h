// SPDX-License-Identifier: Apache-2.0
// A program that has been compiled and checked: what a renderer runs.
#ifndef QUINTET_PROGRAM_RUNNABLE_PROGRAM_H
#define QUINTET_PROGRAM_RUNNABLE_PROGRAM_H

#include <cstdint>

#include "program/compile.h"
#include "program/description/program.h"

namespace quintet::program {

struct RunnableProgram {
  Program description;               // stages, ray types, outputs, and parameters
  CompiledProgram compiled;          // SPIR-V of every stage
  std::uint32_t recursionDepth = 1;  // nesting of traceRayEXT calls; 1 if only ray generation traces
  bool countsRecursion = false;      // the stages are compiled with Instrumentation::recursion
  bool countsHeat = false;           // the stages have Probes::heat
};

}  // namespace quintet::program
#endif
