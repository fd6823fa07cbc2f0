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

// True if each path through the stage ends with ignoreIntersectionEXT.
bool ignoresAlways(const spirv::StageFacts& facts) {
  const spirv::Module& module = facts.module();
  const spirv::Function* entry = module.entry();
  if (!entry || !facts.ignores() || callsFunctions(module)) return false;
  const auto position = module.position(entry->blocks.empty() ? 0 : entry->blocks[0].first);
  if (!position) return false;
  const spirv::ControlFlow& flow = facts.flow(position->function);
  for (std::size_t b = 0; b < entry->blocks.size(); ++b) {
    const Op end = module.instructions()[entry->blocks[b].end - 1].op;
    const bool leaves = entry->blocks[b].successors.empty() && end != Op::OpUnreachable;
    if (flow.reachable(b) && leaves && end != Op::OpIgnoreIntersectionKHR) return false;
  }
  return true;
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
  return std::ranges::all_of(graph.traces, [&](const TraceSite& site) {
    const auto has = [&](Role role) {
      return std::ranges::any_of(site.edges, [&](const Edge& e) {
        return e.role == role && e.hit.group == hit.group && e.hit.ray == hit.ray;
      });
    };
    return !has(Role::closestHit) || has(Role::anyHit);
  });
}

void checkAnyHit(const PipelineGraph& graph, const PipelineStage& stage, HitGroupRay hit, Report& report) {
  if (!ignoresAlways(*stage.facts) || hasEffects(*stage.facts) || writesPayload(*stage.facts)) return;
  const bool shaded = !graph.shaders(hit).closestHit.empty();
  if (shaded ? !alwaysTested(graph, hit) : hasOnlyIgnore(stage)) return;
  const auto& instructions = stage.facts->module().instructions();
  const auto ignore = std::ranges::find(instructions, Op::OpIgnoreIntersectionKHR, &spirv::Instruction::op);
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
    if (input.featureDefines || !stage.facts->reports().empty() || callsFunctions(stage.facts->module())) continue;
    report.add(
        "Q206", mainLocation(graph, stage),
        fmt::format("intersection shader '{}' never reports an intersection, so no ray hits its geometry", stage.file));
  }
  for (std::size_t group = 0; group < graph.program.hitGroups.size(); ++group)
    for (std::size_t ray = 0; ray < graph.rayCount(); ++ray)
      if (const PipelineStage* stage = graph.stage(graph.shaders({group, ray}).anyHit); stage && stage->facts)
        checkAnyHit(graph, *stage, {group, ray}, report);
}

}  // namespace quintet::check
