// SPDX-License-Identifier: Apache-2.0
// Which values the scalars of a module can have: an abstract interpretation by ranges. It follows constants, composites,
// constant arrays, arithmetic, selections, counted loops and the branches that lead to an instruction. ValueContext adds
// what the module does not know: built-ins, parameters and records.
//
// An unknown value has the range of its type.
#ifndef QUINTET_SPIRV_VALUE_RANGES_H
#define QUINTET_SPIRV_VALUE_RANGES_H

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "spirv/module.h"
#include "spirv/value_range.h"

namespace quintet::spirv {

// What is known about values from outside of the module.
struct ValueContext {
  std::map<spv::BuiltIn, ValueRange> builtIns;  // of each component; replaces the limits of Vulkan
  // Members of structures in buffers, by the names of structure and member; one range per component, or one for all.
  std::map<std::pair<std::string, std::string>, std::vector<ValueRange>> members;
  std::optional<ValueRange> hitAttribute;  // of each component
  std::span<const std::byte> record;       // data of the shader record, after the handle; empty if unknown
  bool noNan = false;                      // leaves out NaN, except for a value that is always NaN
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

}  // namespace quintet::spirv
#endif
