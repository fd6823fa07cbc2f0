// SPDX-License-Identifier: Apache-2.0
// Which values a scalar can have: an abstract interpretation of a module by intervals, small sets and known bits. It
// follows constants, composites, constant arrays, arithmetic, selections, counted loops and the branches that lead to
// an instruction. ValueContext adds what the module does not know: built-ins, parameters and records.
//
// A range contains every value that can occur. An unknown value has the range of its type.
#ifndef QUINTET_SPIRV_VALUE_RANGE_H
#define QUINTET_SPIRV_VALUE_RANGE_H

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "spirv/control_flow.h"
#include "spirv/value_part.h"

namespace quintet::spirv {

// How much of a range occurs. Only `each` proves that a wrong value is used.
enum class Occurrence {
  unknown,
  each,  // each of ValueRange::values occurs, or min and max if there are none, wherever no branch depends on it
  many,  // long runs of consecutive integers, such as the coordinates of pixels
};

// Integers of up to 32 bits, booleans (0 or 1) and floats.
struct ValueRange {
  double min = -std::numeric_limits<double>::infinity();  // inclusive
  double max = std::numeric_limits<double>::infinity();
  std::vector<double> values;         // all values, sorted; empty if they are unknown or more than kMaxValues
  std::uint32_t ones = 0, zeros = 0;  // bits of an integer that are always set, never set
  bool nan = true;                    // NaN is possible
  Occurrence occurrence = Occurrence::unknown;

  static constexpr std::size_t kMaxValues = 16;

  static ValueRange of(double value);
  static ValueRange between(double min, double max, Occurrence occurrence = Occurrence::unknown);  // not NaN
  static ValueRange among(std::vector<double> values, Occurrence occurrence);                      // not NaN

  bool empty() const { return min > max && !nan; }  // the instruction never runs
  std::optional<double> constant() const { return min == max && !nan ? std::optional(min) : std::nullopt; }
  // A value of at least `count` that certainly occurs: min, or the largest value. Nullopt if there may be none.
  std::optional<double> atLeast(double count) const;
  bool contains(double value) const;
};

// What is known about values from outside of the module.
struct ValueContext {
  std::map<spv::BuiltIn, ValueRange> builtIns;  // of each component; replaces the limits of Vulkan
  // Members of structures in buffers, by the names of structure and member; one range per component, or one for all.
  std::map<std::pair<std::string, std::string>, std::vector<ValueRange>> members;
};

class ValueRanges {
 public:
  // `module` must outlive this object.
  explicit ValueRanges(const Module& module, ValueContext context = {});
  ~ValueRanges();
  ValueRanges(ValueRanges&&) noexcept;
  ValueRanges& operator=(ValueRanges&&) noexcept;

  // Range of a value, or of a part of a composite, in all invocations.
  ValueRange range(Id value, const Path& path = {}) const;
  // The same where an instruction runs: the conditions of the branches that lead to it are true. Empty if it never
  // runs.
  ValueRange rangeAt(std::size_t instruction, Id value, const Path& path = {}) const;
  // True if a branch whose condition depends on what the value is computed from decides whether the instruction runs.
  // The conditions of counted loops do not count.
  bool guarded(std::size_t instruction, Id value) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The member of a buffer that is read or written: the innermost structure and its member.
struct BufferMember {
  std::string structure, member;
  std::uint32_t component = 0;
};
// Returns the member of a structure in a buffer or push constant that a load or store accesses, with `path` into the
// value. Nullopt for any other storage.
std::optional<BufferMember> bufferMember(const Module& module, const Instruction& access, const Path& path = {});

}  // namespace quintet::spirv
#endif
