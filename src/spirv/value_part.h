// SPDX-License-Identifier: Apache-2.0
// Parts of composite values: which instruction makes a component, member or element.
#ifndef QUINTET_SPIRV_VALUE_PART_H
#define QUINTET_SPIRV_VALUE_PART_H

#include <compare>

#include "spirv/module.h"

namespace quintet::spirv {

// A constituent of a value: the part of `id` with this path.
struct ValuePart {
  Id id = 0;
  Path path{};
  auto operator<=>(const ValuePart&) const = default;
};

// Follows a part through copies and through instructions that compose, extract, insert and shuffle, to the instruction that
// makes it.
ValuePart originOf(const Module& module, ValuePart part);

}  // namespace quintet::spirv
#endif
