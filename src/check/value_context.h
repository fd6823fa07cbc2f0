// SPDX-License-Identifier: Apache-2.0
// What program.toml and a scene say about the values in a stage: ranges of parameters, data of records, built-ins of a
// hit.
#ifndef QUINTET_CHECK_VALUE_CONTEXT_H
#define QUINTET_CHECK_VALUE_CONTEXT_H

#include <initializer_list>
#include <set>
#include <string>
#include <vector>

#include "program/description/program.h"
#include "program/scene_facts.h"
#include "spirv/value_ranges.h"

namespace quintet::check {

enum class ParameterUse {
  any,       // all values that the declarations allow
  defaults,  // the defaults
};

// `file` is the stage's file in the program description. A null `scene` stands for any scene.
spirv::ValueContext valueContext(const program::Program& program, const std::string& file,
                                 const program::SceneFacts* scene, ParameterUse parameters = ParameterUse::any);

// What the hit groups that use a stage say about its values: hit kinds, barycentrics.
spirv::ValueContext groupContext(const std::vector<program::HitGroup>& hitGroups, const std::string& file);

// The numbers of the instances whose hits a stage gets. `each`: each of them occurs.
void addCustomIndices(const std::set<double>& indices, bool each, spirv::ValueContext& context);

// The numbers of the geometries that a stage gets, each of which occurs.
void addGeometryIndices(const std::set<double>& indices, spirv::ValueContext& context);

// Ranges in a stage if all parameters have their defaults.
class DefaultRanges {
 public:
  // `module` must outlive this object.
  DefaultRanges(spirv::ValueContext context, const spirv::Module& module);

  spirv::ValueRange at(std::size_t instruction, spirv::Id value, const spirv::Path& path = {}) const {
    return ranges_.rangeAt(instruction, value, path);
  }
  // The parameters from which the values are computed: "parameter 'bias'", "parameters 'a' and 'b'"; empty if none.
  std::string parameters(std::initializer_list<spirv::Id> values) const;

 private:
  const spirv::Module& module_;
  spirv::ValueRanges ranges_;
};

}  // namespace quintet::check
#endif
