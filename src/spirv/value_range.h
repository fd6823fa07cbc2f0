// SPDX-License-Identifier: Apache-2.0
// Sets of values that a scalar can have, as intervals, small sets and known bits, and the arithmetic of SPIR-V on them.
//
// A range contains every value that can occur. The result of an operation contains all results of its operands' values.
#ifndef QUINTET_SPIRV_VALUE_RANGE_H
#define QUINTET_SPIRV_VALUE_RANGE_H

#include <cstdint>
#include <limits>
#include <optional>
#include <spirv/unified1/spirv.hpp11>
#include <vector>

#include "spirv/comparison.h"
#include "spirv/type.h"

namespace quintet::spirv {

// How much of a range occurs. Only `each` proves that a wrong value is used.
enum class Occurrence {
  unknown,
  each,  // each of ValueRange::values occurs, or min and max if there are none, wherever no branch depends on it
  many,  // runs of at least ValueRange::run consecutive integers, as far as the range allows, such as coordinates of pixels
};
constexpr double kLongRun = 256;
constexpr double kInf = std::numeric_limits<double>::infinity();

// Integers of up to 32 bits, booleans (0 or 1) and floats.
struct ValueRange {
  double min = -kInf;  // inclusive
  double max = kInf;
  std::vector<double> values;         // all values, sorted; empty if they are unknown or more than kMaxValues
  std::uint32_t ones = 0, zeros = 0;  // bits of an integer that are always set, never set
  bool nan = true;                    // NaN is possible
  Occurrence occurrence = Occurrence::unknown;
  double run = kLongRun;  // of Occurrence::many; a division makes runs shorter

  static constexpr std::size_t kMaxValues = 16;

  static ValueRange of(double value);
  static ValueRange between(double min, double max, Occurrence occurrence = Occurrence::unknown);  // not NaN
  static ValueRange among(std::vector<double> values, Occurrence occurrence);                      // not NaN

  bool empty() const { return min > max && !nan; }  // the instruction never runs
  bool onlyNan() const { return min > max && nan; }
  std::optional<double> constant() const { return min == max && !nan ? std::optional(min) : std::nullopt; }
  // Min or max, if a value of at least `count` certainly occurs: some value does in the first case, max in the second.
  std::optional<double> atLeast(double count) const;
  bool contains(double value) const;
};

// Types that ranges distinguish; a value of any other type has an unlimited range.
bool isInteger(const Type& type);  // of up to 32 bits
bool isFloat(const Type& type);    // of 32 bits
double lowest(const Type& integer);
double highest(const Type& integer);

constexpr double kRangeError = 1.0 / (1 << 20);  // relative, of float operations that are not correctly rounded

ValueRange rangeOf(const Type& type);  // of an unknown value
ValueRange never();                    // no value
ValueRange onlyNan();
ValueRange truth(std::optional<bool> value);  // 0, 1, or both

// The value as the type stores it: modulo 2^width, or rounded.
double stored(const Type& type, double value);
// Limits the range to the type, and derives bits from values and values from bits.
ValueRange fitted(const Type& type, ValueRange range);

ValueRange joined(const ValueRange& a, const ValueRange& b);   // union
ValueRange limited(ValueRange range, double min, double max);  // intersection; excludes NaN

// `op` is an addition, subtraction, multiplication, division or remainder.
ValueRange binary(const Type& type, spv::Op op, const ValueRange& a, const ValueRange& b);
ValueRange bitwise(const Type& type, spv::Op op, const ValueRange& a, const ValueRange& b);  // or a shift
ValueRange compared(const Comparison& comparison, const ValueRange& a, const ValueRange& b);
// `monotone` maps consecutive integers to consecutive integers.
ValueRange mapped(const Type& type, const ValueRange& a, double (*monotone)(double));
ValueRange signOf(const Type& type, const ValueRange& a);  // -1, 0 or 1
ValueRange magnitude(const Type& type, const ValueRange& a);
// min(a, b), or max(a, b) if `larger`. A NaN can give either operand.
ValueRange chosen(const Type& type, const ValueRange& a, const ValueRange& b, bool larger);
ValueRange clamped(const Type& type, ValueRange a, const ValueRange& low, const ValueRange& high);

}  // namespace quintet::spirv
#endif
