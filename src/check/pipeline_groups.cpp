// SPDX-License-Identifier: Apache-2.0
#include "check/pipeline_groups.h"

#include <set>
#include <string>
#include <vector>

#include "program/hit_group_binding.h"

namespace quintet::check {

bool mayBeProcedural(const PipelineGroups& groups, const program::HitGroup& group) {
  return program::hasIntersection(group) || (!groups.groupsKnown && groups.hasIntersections);
}

PipelineGroups groupsOf(const program::Program& program) {
  PipelineGroups groups;
  groups.rayGenerations = {program.rayGeneration};
  groups.misses = program::missShaders(program);
  groups.hitGroups = program.hitGroups;
  groups.callables = program.callables;
  for (const program::RayType& ray : program.rays) groups.rays.push_back(ray.name);
  groups.declaredRecursion = program.declaredRecursion;
  groups.origin = program.origin;
  groups.descriptionFile = program.descriptionFile;
  groups.files = program.files;
  return groups;
}

PipelineGroups withoutRepeatedGroups(PipelineGroups groups) {
  using Files = std::vector<std::string>;
  const auto removeRepeated = [](auto& list, const auto& filesOf) {
    std::set<Files> known;
    std::erase_if(list, [&](const auto& group) { return !known.insert(filesOf(group)).second; });
  };
  removeRepeated(groups.misses, [](const program::MissShader& miss) { return Files{miss.file}; });
  removeRepeated(groups.callables, [](const program::Callable& callable) { return Files{callable.file}; });
  removeRepeated(groups.hitGroups, [](const program::HitGroup& group) {
    Files files;
    for (const auto& [ray, shaders] : group.shaders)
      files.insert(files.end(), {ray, shaders.closestHit, shaders.anyHit, shaders.intersection});
    return files;
  });
  return groups;
}

}  // namespace quintet::check
