// SPDX-License-Identifier: Apache-2.0
#include "check/pipeline_groups.h"

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

}  // namespace quintet::check
