// SPDX-License-Identifier: Apache-2.0
// Q801: stages that no trace or call can reach. Q802: hit groups that match no geometry.
#include <fmt/format.h>

#include <algorithm>

#include "check/rules/across_stages/binding_names.h"
#include "check/rules/across_stages/shared_data.h"
#include "check/rules/rules.h"
#include "program/lecture/lecture.h"

namespace quintet::check {
namespace {

// Returns the line of the first mention of a file in the description of the groups; 0 if unknown.
int lineOfFile(const PipelineGroups& groups, const std::string& file) {
  for (const program::MissShader& miss : groups.misses)
    if (miss.file == file) return miss.line;
  for (const program::Callable& callable : groups.callables)
    if (callable.file == file) return callable.line;
  for (const program::HitGroup& group : groups.hitGroups)
    for (const auto& [ray, shaders] : group.shaders)
      if (shaders.closestHit == file || shaders.anyHit == file || shaders.intersection == file)
        return shaders.line > 0 ? shaders.line : group.line;
  return 0;  // ray generation is always reachable
}

bool isBound(const program::HitGroup& group) {
  return !group.geometry.empty() || !group.material.empty() || !group.primitives.empty();
}

// Describes the first name in the group's binding that the scene does not have; empty if it has all. Geometry classes
// are ignored.
std::string missingName(const program::Program& program, std::size_t group, const program::SceneFacts& scene) {
  for (const UnknownName& unknown : unknownNames(program, scene))
    if (unknown.group == group)
      return fmt::format("{} has no {} '{}'{}", scene.name, unknown.material ? "material" : "mesh or primitive set",
                         unknown.name,
                         unknown.nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", unknown.nearest));
  return {};
}

// True if geometry that matches `group` uses `earlier`, which comes before it.
bool isHiddenBy(const PipelineGraph& graph, std::size_t group, std::size_t earlier) {
  const program::HitGroup& a = graph.groups.hitGroups[earlier];
  const program::HitGroup& b = graph.groups.hitGroups[group];
  if (a.geometry != b.geometry || a.material != b.material || a.primitives != b.primitives) return false;
  // Groups that are bound by material only are not compared.
  if (isBound(b) && b.geometry.empty() && b.primitives.empty()) return false;
  return graph.hasIntersection(earlier) == graph.hasIntersection(group);
}

// Returns why no geometry uses the hit group; empty if some can.
std::string reasonUnused(const ProgramInput& input, std::size_t index) {
  const program::Program& program = input.program;
  const program::HitGroup& group = program.hitGroups[index];
  for (std::size_t earlier = 0; earlier < index; ++earlier)
    if (isHiddenBy(input.graph, index, earlier))
      return fmt::format("hit group '{}' has the same binding and comes first", program.hitGroups[earlier].name);
  if (!input.scene || input.scene->geometries.empty()) return {};
  if (!group.geometry.empty() || (group.primitives.empty() && group.material.empty())) return {};
  const auto uses = [&](const program::GeometryFacts& geometry) {
    return program::hitGroupFor(program, geometry) == index;
  };
  if (std::ranges::any_of(input.scene->geometries, uses)) return {};
  const std::string missing = missingName(program, index, *input.scene);
  return missing.empty() ? "other groups come first for all geometry with these names" : missing;
}

}  // namespace

void checkUnreachableStages(const CheckInput& input, Report& report) {
  const PipelineGraph& graph = input.graph;
  const std::set<std::size_t> reachable = graph.reachableStages();
  for (std::size_t i = 0; i < graph.stages.size(); ++i) {
    const PipelineStage& stage = graph.stages[i];
    const auto isReached = [&](std::size_t other) { return graph.areVariants(stage, graph.stages[other]); };
    if (reachable.contains(i) || std::ranges::any_of(reachable, isReached) ||
        stage.file.ends_with(program::kStubMissExtension))
      continue;
    const int line = lineOfFile(graph.groups, stage.file);
    // The description has no lines in the lecture form, where both variants of a stage can be unreachable.
    report.addOncePerLine("Q801", line > 0 ? graph.descriptionLocation(line) : mainLocation(graph, stage),
                          fmt::format("no trace or call can reach {} shader '{}'", shader::stageName(stage.kind),
                                      graph.nameOf(stage.file)));
  }
}

void checkUnusedHitGroups(const ProgramInput& input, Report& report) {
  const std::vector<program::HitGroup>& groups = input.program.hitGroups;
  for (std::size_t i = 0; i < groups.size(); ++i)
    if (const std::string reason = reasonUnused(input, i); !reason.empty())
      report.add("Q802", input.graph.descriptionLocation(groups[i].line),
                 fmt::format("hit group '{}' matches no geometry: {}", groups[i].name, reason));
}

}  // namespace quintet::check
