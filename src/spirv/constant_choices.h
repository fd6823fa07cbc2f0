// SPDX-License-Identifier: Apache-2.0
// Whether specialization constants decide which code of a module runs, or with which flags it traces. Code that they exclude in one
// pipeline can run in another one with the same modules.
#ifndef QUINTET_SPIRV_CONSTANT_CHOICES_H
#define QUINTET_SPIRV_CONSTANT_CHOICES_H

#include "spirv/module.h"

namespace quintet::spirv {

// True if a condition, a selector or an argument of a trace or call is computed from specialization constants alone. The module
// must not be specialized yet. Values that are passed to functions are not followed.
bool constantsChoose(const Module& module);

}  // namespace quintet::spirv
#endif
