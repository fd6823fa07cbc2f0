// SPDX-License-Identifier: Apache-2.0
// Comparison instructions of integers, floats and booleans.
#ifndef QUINTET_SPIRV_COMPARISON_H
#define QUINTET_SPIRV_COMPARISON_H

#include <optional>
#include <spirv/unified1/spirv.hpp11>

#include "spirv/type.h"

namespace quintet::spirv {

enum class Relation { equal, notEqual, less, lessOrEqual, greater, greaterOrEqual };

struct Comparison {
  Relation relation = Relation::equal;
  bool isUnsigned = false;
  bool unordered = false;  // true for NaN
};

// Returns nullopt for any other instruction.
std::optional<Comparison> comparisonOf(spv::Op op);

// True if the instruction orders integers of `type` as their type does. SPIR-V allows any signedness.
bool hasSignOf(const Comparison& comparison, const Type& type);

Relation negated(Relation relation);   // a < b as a >= b
Relation mirrored(Relation relation);  // a < b as b > a

bool holds(const Comparison& comparison, double a, double b);

}  // namespace quintet::spirv
#endif
