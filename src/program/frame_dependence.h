// SPDX-License-Identifier: Apache-2.0
// Whether the frames of a program can differ, so that front ends need not render the same image again and again.
#ifndef QUINTET_PROGRAM_FRAME_DEPENDENCE_H
#define QUINTET_PROGRAM_FRAME_DEPENDENCE_H

#include "program/description/program.h"

namespace quintet::program {

// For a program that accumulates, in a scene that does not move: returns false only if all frames are equal, because no
// source of the program uses the index of the frame, the previous frame or a clock. A program that includes the shader
// library counts as one that does.
bool framesCanDiffer(const Program& program);

}  // namespace quintet::program
#endif
