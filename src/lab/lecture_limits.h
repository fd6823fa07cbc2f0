// SPDX-License-Identifier: Apache-2.0
// Why a lecture file (docs/lecture-form.md) cannot express a program in a folder: reasons for the user why the program is
// exported as a zip file only.
#ifndef QUINTET_LAB_LECTURE_LIMITS_H
#define QUINTET_LAB_LECTURE_LIMITS_H

#include <string>
#include <vector>

#include "program/description/program.h"

namespace quintet::lab {

// Parts of a sentence: "it has the ray types radiance, shadow". Empty for a lecture file, and for a folder that has nothing
// else.
std::vector<std::string> lectureObstacles(const program::Program& program);

}  // namespace quintet::lab
#endif
