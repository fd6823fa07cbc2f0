// SPDX-License-Identifier: Apache-2.0
// Runtime checks of each hit (Instrumentation::checks), also where no shader of the program runs.
#ifndef QUINTET_PROGRAM_HIT_CHECKS_H
#define QUINTET_PROGRAM_HIT_CHECKS_H

#include "program/description/program.h"

namespace quintet::program {

// The closest-hit shader of hit groups without one: it only checks the hit.
inline constexpr const char* kHitCheckStage = "<quintet/stages/self_hit.rchit>";

// Returns the program with a closest-hit shader in each hit group for each ray type.
Program withHitChecks(Program program);

}  // namespace quintet::program
#endif
