// SPDX-License-Identifier: Apache-2.0
#include "check/modules/stage_groups.h"

#include <string>
#include <utility>
#include <vector>

namespace quintet::check {
namespace {

using shader::Stage;

std::vector<std::string> namesOf(std::span<const ModuleStage> stages, Stage kind) {
  std::vector<std::string> names;
  for (const ModuleStage& stage : stages)
    if (stage.kind == kind) names.push_back(stage.name);
  return names;
}

program::HitGroup hitGroup(const std::string& name, program::HitShaders shaders) {
  program::HitGroup group;
  group.name = name.substr(name.rfind('/') + 1);
  group.shaders[""] = std::move(shaders);
  return group;
}

}  // namespace

PipelineGroups groupsOfStages(std::span<const ModuleStage> stages) {
  PipelineGroups groups;
  groups.noun = "pipeline";
  groups.rays = {""};
  groups.hitRecords = HitRecords::byRecord;
  groups.tablesKnown = groups.groupsKnown = false;
  groups.rayGenerations = namesOf(stages, Stage::rayGeneration);
  for (const std::string& file : namesOf(stages, Stage::miss)) groups.misses.push_back({{}, file, {}, 0});
  for (const std::string& file : namesOf(stages, Stage::callable)) groups.callables.push_back({{}, file, {}, 0});
  const auto closest = namesOf(stages, Stage::closestHit), any = namesOf(stages, Stage::anyHit),
             intersections = namesOf(stages, Stage::intersection);
  groups.hasIntersections = !intersections.empty();
  const auto add = [&](const std::vector<std::string>& files, std::string program::HitShaders::*member) {
    for (const std::string& file : files) {
      program::HitShaders shaders;
      shaders.*member = file;
      groups.hitGroups.push_back(hitGroup(file, std::move(shaders)));
    }
  };
  add(closest, &program::HitShaders::closestHit);
  add(any, &program::HitShaders::anyHit);
  add(intersections, &program::HitShaders::intersection);
  return groups;
}

}  // namespace quintet::check
