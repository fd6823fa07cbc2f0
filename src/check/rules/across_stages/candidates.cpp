// SPDX-License-Identifier: Apache-2.0
// Q206: an intersection shader that never reports an intersection. Q606: an any-hit shader that ignores every one.
#include <fmt/format.h>

#include <algorithm>

#include "check/rules/across_stages/shared_data.h"
#include "check/rules/rules.h"
#include "spirv/source_text.h"

namespace quintet::check {
namespace {

using spv::Op;

bool callsFunctions(const spirv::Module& module) {
  return std::ranges::any_of(module.instructions(), [](const auto& i) { return i.op == Op::OpFunctionCall; });
}

// Returns the first ignoreIntersectionEXT if each path through the stage ends with one; else null. A branch whose
// condition always has the same value, other than for NaN, leads only there.
const spirv::Instruction* ignoreOfEachPath(const CheckInput& input, const PipelineStage& stage) {
  const spirv::Module& module = stage.facts->module();
  const spirv::Function* entry = module.entry();
  if (!entry || entry->blocks.empty() || !stage.facts->ignores() || callsFunctions(module)) return nullptr;
  spirv::ValueContext context = input.graph.context(stage.file, input.scene);
  context.noNan = true;
  const spirv::ValueRanges ranges(module, std::move(context));
  const auto& blocks = entry->blocks;
  std::vector<bool> seen(blocks.size(), false);
  std::vector<std::size_t> open{0};
  std::size_t first = spirv::Module::kNone;
  while (!open.empty()) {
    const std::size_t block = open.back();
    open.pop_back();
    if (seen[block]) continue;
    seen[block] = true;
    const std::size_t last = blocks[block].end - 1;
    const spirv::Instruction& end = module.instructions()[last];
    if (end.op == Op::OpIgnoreIntersectionKHR)
      first = std::min(first, last);
    else if (blocks[block].successors.empty() && end.op != Op::OpUnreachable)
      return nullptr;
    const std::optional<double> condition =
        end.op == Op::OpBranchConditional ? ranges.rangeAt(last, end.at(0)).constant() : std::nullopt;
    for (const std::size_t next : blocks[block].successors)
      if (!condition || blocks[next].label == end.at(*condition != 0.0 ? 1 : 2)) open.push_back(next);
  }
  return first == spirv::Module::kNone ? nullptr : &module.instructions()[first];
}

// The lecture form compiles an any-hit shader for triangles and for procedural geometry. An attribute that only one of
// them has is 0 in the other one.
bool allVariantsIgnore(const CheckInput& input, const PipelineStage& stage) {
  return std::ranges::all_of(input.graph.stages, [&](const PipelineStage& other) {
    return !input.graph.areVariants(stage, other) || !other.facts || ignoreOfEachPath(input, other);
  });
}

bool writesPayload(const spirv::StageFacts& facts) {
  return std::ranges::any_of(facts.accesses(), [](const spirv::AccessFacts& a) { return a.writes; });
}

// True if main() has only the statement: the shader hides the geometry from these rays on purpose.
bool hasOnlyIgnore(const PipelineStage& stage) {
  for (const auto& [file, text] : stage.facts->module().sources()) {
    const std::size_t at = spirv::findToken(text, "main");
    const std::size_t begin = at == text.npos ? text.npos : text.find('{', at);
    const std::size_t end = begin == text.npos ? text.npos : text.find('}', begin);
    if (end == text.npos) continue;
    std::string body;
    bool comment = false;
    for (std::size_t i = begin + 1; i < end; ++i) {
      if (text.compare(i, 2, "//") == 0) comment = true;
      if (text[i] == '\n') comment = false;
      if (!comment && text[i] != ' ' && text[i] != '\t' && text[i] != '\n' && text[i] != '\r') body += text[i];
    }
    if (body == "ignoreIntersectionEXT;") return true;
  }
  return false;
}

// True if each trace that can run the closest-hit shader of the hit group can run its any-hit shader, too.
bool alwaysTested(const PipelineGraph& graph, HitGroupRay hit) {
  return std::ranges::all_of(graph.targets, [&](const TraceTargets& targets) {
    const auto has = [&](Role role) {
      return std::ranges::find(edgesOf(targets.edges, hit), role, &Edge::role) != edgesOf(targets.edges, hit).end();
    };
    const TraceSite& first = graph.traces[targets.traces.front()];
    if (first.isSearch()) return std::ranges::find(targets.hits, hit) == targets.hits.end() || has(Role::anyHit);
    // Hit objects that no trace of the stage has filled are not tested.
    if (first.isExecution()) return !has(Role::closestHit) || first.trace->ray != spirv::Module::kNone;
    return !has(Role::closestHit) || has(Role::anyHit);
  });
}

void checkAnyHit(const CheckInput& input, const PipelineStage& stage, HitGroupRay hit, Report& report) {
  const PipelineGraph& graph = input.graph;
  if (hasEffects(*stage.facts) || writesPayload(*stage.facts)) return;
  const spirv::Instruction* ignore = ignoreOfEachPath(input, stage);
  if (!ignore || !allVariantsIgnore(input, stage)) return;
  const bool shaded = !graph.shaders(hit).closestHit.empty();
  if (shaded ? !alwaysTested(graph, hit) : hasOnlyIgnore(stage)) return;
  const SourceLocation location = stage.facts->module().location(*ignore, "ignoreIntersectionEXT");
  report.addOncePerLine(
      "Q606", location.line > 0 ? location : mainLocation(graph, stage),
      fmt::format("any-hit shader '{}' ignores every intersection: the rays pass through all geometry "
                  "of {}{}",
                  stage.file, graph.describe(hit), shaded ? ", and its closest-hit shader never runs" : ""));
}

}  // namespace

void checkCandidates(const CheckInput& input, Report& report) {
  const PipelineGraph& graph = input.graph;
  for (const PipelineStage& stage : graph.stages) {
    if (stage.kind != shader::Stage::intersection || !stage.facts || program::isLibraryStage(stage.file)) continue;
    if (input.featureDefines || stage.isStub || !stage.facts->reports().empty() ||
        callsFunctions(stage.facts->module()))
      continue;
    report.add(
        "Q206", mainLocation(graph, stage),
        fmt::format("intersection shader '{}' never reports an intersection, so no ray hits its geometry", stage.file));
  }
  for (std::size_t group = 0; group < graph.groups.hitGroups.size(); ++group)
    for (std::size_t ray = 0; ray < graph.rayCount(); ++ray)
      if (const PipelineStage* stage = graph.stage(graph.shaders({group, ray}).anyHit); stage && stage->facts)
        checkAnyHit(input, *stage, {group, ray}, report);
}

}  // namespace quintet::check
