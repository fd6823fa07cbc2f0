// SPDX-License-Identifier: Apache-2.0
// The order of the rules, within each stage and across stages.
#include "check/check.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "check/rules/rules.h"

namespace quintet::check {
namespace {

// A wrong index leaves stages unreachable. Only the index is reported then.
constexpr std::array<std::string_view, 6> kWrongIndex{"Q302", "Q501", "Q502", "Q503", "Q504", "Q506"};

bool hasAnyHit(const program::Program& program, const std::string& intersection) {
  return std::ranges::any_of(program.hitGroups, [&](const program::HitGroup& group) {
    return std::ranges::any_of(group.shaders, [&](const auto& entry) {
      return entry.second.intersection == intersection && !entry.second.anyHit.empty();
    });
  });
}

void runRulesWithinStages(const CheckInput& input, Report& report) {
  const PipelineGraph& graph = input.graph;
  std::vector<std::vector<Diagnostic>> found(graph.stages.size());
  parallelFor(graph.stages.size(), [&](std::size_t i) {
    const PipelineStage& stage = graph.stages[i];
    if (!stage.facts) return;
    const StageContext context{graph.program.keepsInstanceOrder, hasAnyHit(graph.program, stage.file),
                               input.limits.defects};
    found[i] = checkStage(stage.facts->module(), context);
  });
  for (std::size_t i = 0; i < found.size(); ++i)
    for (Diagnostic& d : found[i])
      report.add(d.id, graph.location(graph.stages[i], {d.file, d.line, d.column}), std::move(d.text));
}

RecursionNeeds runRulesAcrossStages(const CheckInput& input, Report& report) {
  checkPayloadTypes(input, report);
  checkPayloadMembers(input, report);
  checkHitAttributes(input, report);
  checkCallableTypes(input, report);
  const RecursionNeeds needs = checkRecursion(input, report);
  checkArguments(input, report);
  checkGeometry(input, report);
  checkRayOrigins(input, report);
  if (input.limits.defects.sharesAnyHit) checkSharedIntersections(input, report);
  if (input.graph.error.empty() && !input.featureDefines && !report.hasAny(kWrongIndex))
    checkUnreachableStages(input, report);
  checkUnusedHitGroups(input, report);
  return needs;
}

}  // namespace

std::vector<Diagnostic> checkStage(const spirv::Module& module, const StageContext& context) {
  using Model = spv::ExecutionModel;
  Report report;
  const auto stage = module.stage();
  if (!stage) return {};
  const bool intersection = stage == Model::IntersectionKHR;
  const bool hit = intersection || stage == Model::AnyHitKHR || stage == Model::ClosestHitKHR;
  if (intersection) checkDistance(module, report);
  if (hit) checkNormals(module, report);
  if (hit && !context.keepsInstanceOrder) checkInstanceIndices(module, report);
  checkDescriptorIndices(module, report);
  checkDebugPrintf(module, report);
  if (intersection) checkRayTmaxReads(module, report);
  const DriverDefects& defects = context.defects;
  if (defects.changesNestedBuiltIns && stage == Model::ClosestHitKHR) checkNestedBuiltIns(module, report);
  if (defects.corruptsHitAttributes && intersection) checkAttributeWrites(module, report);
  if (defects.sharesLocalArrays && intersection && context.hasAnyHit) checkLocalArrays(module, report);
  return report.take();
}

CheckResult check(const program::Program& program, const program::CompiledProgram& compiled,
                  const program::SceneFacts* scene, const DeviceLimits& limits, bool featureDefines) {
  const Stopwatch clock;
  CheckResult result;
  result.diagnostics = compiled.diagnostics;
  result.recursionDepth = program.declaredRecursion.value_or(1);
  if (compiled.ok) {
    const PipelineGraph graph(program, compiled);
    const std::optional<program::SceneFacts> facts =
        scene ? std::optional(program::factsFor(program, *scene)) : std::nullopt;
    const CheckInput input{graph, facts ? &*facts : nullptr, limits, featureDefines};
    Report report;
    runRulesWithinStages(input, report);
    const RecursionNeeds needs = runRulesAcrossStages(input, report);
    result.recursionDepth = needs.depth;
    result.stackBytes = needs.stackBytes;
    if (graph.error.empty())
      for (const std::size_t stage : graph.reachableStages()) result.reached.push_back(graph.stages[stage].file);
    for (Diagnostic& d : report.take()) {
      d.file = program::userFile(program, d.file);
      result.diagnostics.push_back(std::move(d));
    }
  }
  result.seconds = compiled.seconds + clock.seconds();
  return result;
}

CheckResult check(const program::Program& program, const shader::Compiler& compiler, const program::SceneFacts* scene,
                  const DeviceLimits& limits, const std::vector<std::pair<std::string, std::string>>& defines) {
  const bool features =
      std::ranges::any_of(defines, [](const auto& define) { return define.first.starts_with("QUINTET_NO_"); });
  return check(program, compile(program, compiler, defines), scene, limits, features);
}

}  // namespace quintet::check
