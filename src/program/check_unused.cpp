// Q801, Q802: stages that nobody reaches, hit groups that serve nothing; and the list of what is reached.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "program/check_parts.h"
#include "program/lecture.h"

namespace quintet::program {
namespace {

// Stages from ray generation on, over traces and calls.
std::set<std::size_t> reachedStages(const LinkModel& model) {
  std::set<std::size_t> reached;
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < model.stages.size(); ++i)
    if (model.stages[i].kind == shader::Stage::rayGeneration) open.push_back(i);
  const auto follow = [&](std::size_t stage, const auto& sites) {
    for (const auto& site : sites)
      if (site.stage == stage)
        for (const Edge& edge : site.edges) open.push_back(edge.stage);
  };
  while (!open.empty()) {
    const std::size_t stage = open.back();
    open.pop_back();
    if (!reached.insert(stage).second) continue;
    follow(stage, model.traces);
    follow(stage, model.calls);
    // An any-hit shader that opacity keeps away is Q603, not Q801.
    for (const TraceSite& site : model.traces) {
      if (site.stage != stage) continue;
      for (const HitRow row : site.hits)
        if (const LinkStage* found = model.stage(model.shaders(row).anyHit))
          open.push_back(static_cast<std::size_t>(found - model.stages.data()));
    }
  }
  return reached;
}

// Where program.toml names a file first.
int lineOf(const Program& program, const std::string& file) {
  for (const MissShader& miss : missShaders(program))
    if (miss.file == file) return miss.line;
  for (const Callable& callable : program.callables)
    if (callable.file == file) return callable.line;
  for (const HitGroup& group : program.hitGroups)
    for (const auto& [ray, shaders] : group.shaders)
      if (shaders.closestHit == file || shaders.anyHit == file || shaders.intersection == file)
        return shaders.line > 0 ? shaders.line : group.line;
  return program.rayGenerationLine;
}

bool isBound(const HitGroup& group) {
  return !group.geometry.empty() || !group.material.empty() || !group.primitives.empty();
}

// Names that the group is bound to and that the scene does not have; classes of geometry do not count.
std::string missingNames(const HitGroup& group, const SceneFacts& scene) {
  const auto has = [&](const std::string& name, auto member) {
    return std::ranges::any_of(scene.geometries, [&](const GeometryFacts& g) { return g.*member == name; });
  };
  for (const std::string& name : group.primitives)
    if (!has(name, &GeometryFacts::name)) return fmt::format("{} has no mesh or primitive set '{}'", scene.name, name);
  for (const std::string& name : group.material)
    if (!has(name, &GeometryFacts::material)) return fmt::format("{} has no material '{}'", scene.name, name);
  return {};
}

void checkGroup(const CheckInput& input, std::size_t index, Report& report) {
  const Program& program = input.model.program;
  const HitGroup& group = program.hitGroups[index];
  const auto add = [&](const std::string& why) {
    report.add("Q802", input.model.at(group.line), fmt::format("hit group '{}' serves nothing: {}", group.name, why));
  };
  for (std::size_t before = 0; before < index; ++before) {
    const HitGroup& other = program.hitGroups[before];
    const bool alike =
        other.geometry == group.geometry && other.material == group.material && other.primitives == group.primitives;
    // Groups without a binding are told apart by their intersection shader.
    if (alike && (isBound(group) ? !group.geometry.empty() || !group.primitives.empty() : true) &&
        input.model.hasIntersection(before) == input.model.hasIntersection(index)) {
      add(fmt::format("hit group '{}' has the same binding and comes first", other.name));
      return;
    }
  }
  if (!input.scene || input.scene->geometries.empty()) return;
  const bool named = group.geometry.empty() && (!group.primitives.empty() || !group.material.empty());
  if (!named) return;
  const auto serves = [&](const GeometryFacts& geometry) { return hitGroupFor(program, geometry) == index; };
  if (std::ranges::any_of(input.scene->geometries, serves)) return;
  const std::string missing = missingNames(group, *input.scene);
  add(missing.empty() ? "other groups come first for every geometry of its names" : missing);
}

}  // namespace

void checkUnused(const CheckInput& input, Report& report, CheckResult& result) {
  const LinkModel& model = input.model;
  if (model.problem.empty()) {
    const std::set<std::size_t> reached = reachedStages(model);
    // What a wrong index misses follows from that mistake.
    constexpr std::string_view kWrongIndex[] = {"Q302", "Q501", "Q502", "Q503", "Q504", "Q506"};
    const bool follows = std::ranges::any_of(kWrongIndex, [&](std::string_view id) { return report.has(id); });
    for (std::size_t i = 0; i < model.stages.size(); ++i) {
      const LinkStage& stage = model.stages[i];
      if (reached.contains(i))
        result.reached.push_back(stage.file);
      else if (!input.featureDefines && !follows && !stage.file.ends_with(kStubMissExtension))
        report.add(
            "Q801", model.at(lineOf(model.program, stage.file)),
            fmt::format("no trace or call can run the {} shader '{}'", shader::stageName(stage.kind), stage.file));
    }
  }
  for (std::size_t i = 0; i < model.program.hitGroups.size(); ++i) checkGroup(input, i, report);
}

}  // namespace quintet::program
