// SPDX-License-Identifier: Apache-2.0
// A closest-hit shader for each hit of an instrumented program (Instrumentation::checks, explain), also where no shader of
// the program runs.
#ifndef QUINTET_PROGRAM_HIT_SHADERS_H
#define QUINTET_PROGRAM_HIT_SHADERS_H

#include "program/description/program.h"
#include "program/instrument.h"

namespace quintet::program {

// Returns the closest-hit shader of hit groups without one: it only checks or logs the hit. It is not instrumented again.
const char* hitStage(Instrumentation instrumentation);
bool isHitStage(const std::string& file);  // of any instrumentation

// Returns the program with a closest-hit shader in each hit group for each ray type.
Program withHitShaders(Program program, Instrumentation instrumentation);

}  // namespace quintet::program
#endif
