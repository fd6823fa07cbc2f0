// SPDX-License-Identifier: Apache-2.0
// Parts of composite values: which instruction makes a component, member or element. Evaluation of constants.
#ifndef QUINTET_SPIRV_VALUE_PART_H
#define QUINTET_SPIRV_VALUE_PART_H

#include <compare>
#include <functional>
#include <optional>

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

// The value of a scalar constant: booleans are 0 or 1. Nullopt if it is not one.
std::optional<double> constantNumber(const Module& module, const ValuePart& value);

// True for a vector of equal components.
bool isSplat(const Module& module, Id value);
// The value of a scalar constant, or of the equal components of a constant vector. Nullopt if it is neither.
std::optional<double> splatConstant(const Module& module, Id value);

// Evaluates comparisons and logical operations of constants and of the values that `known` returns. Nullopt if the value
// depends on anything else.
std::optional<double> evaluate(const Module& module, Id value, const std::function<std::optional<double>(Id)>& known,
                               int depth = 0);

}  // namespace quintet::spirv
#endif
