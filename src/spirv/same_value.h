// SPDX-License-Identifier: Apache-2.0
// Equal values with different ids.
#ifndef QUINTET_SPIRV_SAME_VALUE_H
#define QUINTET_SPIRV_SAME_VALUE_H

#include "spirv/module.h"

namespace quintet::spirv {

// True for the results of pure instructions with equal operands. Loads of one address of a buffer are equal.
bool sameValue(const Module& module, Id a, Id b);

}  // namespace quintet::spirv
#endif
