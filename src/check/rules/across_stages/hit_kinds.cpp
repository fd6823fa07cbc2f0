// SPDX-License-Identifier: Apache-2.0
// Q607: kinds of triangle hits in shaders of procedural hit groups. Q608: reported hit kinds that Vulkan reserves.
#include <fmt/format.h>

#include <algorithm>

#include "check/rules/rules.h"
#include "spirv/glsl_declaration.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spv::Op;

constexpr std::uint32_t kMaxHitKind = 127, kFrontFacing = 0xFE, kBackFacing = 0xFF;

// True if the stage runs only for procedural geometry. The lecture form compiles hit shaders for both kinds.
bool onlyProcedural(const PipelineGraph& graph, const std::string& file, const program::SceneFacts* scene) {
  bool found = false;
  const bool sceneHasTriangles =
      !scene || std::ranges::any_of(scene->geometries, [](const auto& geometry) { return !geometry.procedural(); });
  for (const program::HitGroup& group : graph.groups.hitGroups) {
    for (const auto& [ray, shaders] : group.shaders) {
      if (shaders.closestHit != file && shaders.anyHit != file) continue;
      if (!graph.hasIntersection(static_cast<std::size_t>(&group - graph.groups.hitGroups.data()))) return false;
      found = true;
    }
  }
  const bool lecture = file.ends_with(".boxes.rchit") || file.ends_with(".boxes.rahit");
  return found && !(lecture && sceneHasTriangles);
}

bool isHitKind(const spirv::Module& module, spirv::Id value) {
  const spirv::Instruction* load = module.definition(spirv::originOf(module, {value}).id);
  return load && spirv::loadsBuiltIn(module, *load, spv::BuiltIn::HitKindKHR);
}

void checkTriangleKinds(const PipelineGraph& graph, const PipelineStage& stage, Report& report) {
  const spirv::Module& module = stage.facts->module();
  for (const spirv::Instruction& i : module.instructions()) {
    if (i.op != Op::OpIEqual && i.op != Op::OpINotEqual) continue;
    const bool first = isHitKind(module, i.at(0));
    if (!first && !isHitKind(module, i.at(1))) continue;
    const std::optional<std::uint32_t> kind = module.constantBits(first ? i.at(1) : i.at(0));
    if (kind != kFrontFacing && kind != kBackFacing) continue;
    const SourceLocation location = module.location(i, "gl_HitKindEXT");
    if (!graph.isOwnFile(location.file)) continue;  // a function of the library for both kinds of geometry
    report.addOncePerLine(
        "Q607", graph.location(stage, location),
        fmt::format("gl_HitKindEXT is compared with gl_HitKind{}FacingTriangleEXT, but this shader runs only for "
                    "procedural geometry, whose hit kind is what the intersection shader reports (0 to {})",
                    kind == kFrontFacing ? "Front" : "Back", kMaxHitKind));
  }
}

// In the lecture form, the library reports; the location is then the first report in the user's file.
SourceLocation hitLocation(const PipelineGraph& graph, const PipelineStage& stage, const SourceLocation& location) {
  if (graph.isOwnFile(location.file)) return location;
  const std::string file = graph.groups.path(graph.groups.descriptionFile);
  const std::string_view text = stage.facts->module().source(file);
  const auto found = spirv::findWord(text, "reportIntersectionEXT");
  return found ? SourceLocation{file, found->line, found->column} : graph.location(stage, location);
}

}  // namespace

void checkHitKinds(const CheckInput& input, Report& report) {
  const PipelineGraph& graph = input.graph;
  for (const PipelineStage& stage : graph.stages) {
    if (!stage.facts) continue;
    for (const spirv::ReportFacts& hit : stage.facts->reports())
      if (const std::optional<std::uint32_t> kind = hit.hitKind.atLeast(kMaxHitKind + 1))
        report.add(
            "Q608", hitLocation(graph, stage, hit.location),
            fmt::format("the hit kind of this report is {}{}, but the maximum is {}; Vulkan reserves larger ones "
                        "for triangles",
                        hit.hitKind.exact()             ? ""
                        : hit.hitKind.min > kMaxHitKind ? "at least "
                                                        : "up to ",
                        hit.hitKind.known && hit.hitKind.min <= kMaxHitKind ? hit.hitKind.values.back() : *kind,
                        kMaxHitKind));
  }
}

void checkTriangleKinds(const ProgramInput& input, Report& report) {
  for (const PipelineStage& stage : input.graph.stages)
    if (stage.facts && stage.kind != shader::Stage::intersection &&
        onlyProcedural(input.graph, stage.file, input.scene))
      checkTriangleKinds(input.graph, stage, report);
}

}  // namespace quintet::check
