// SPDX-License-Identifier: Apache-2.0
// Q201 to Q203: type and size of hit attributes. Q205: attributes that the intersection shader does not write.
#include <fmt/format.h>

#include <algorithm>

#include "check/library_names.h"
#include "check/rules/across_stages/shared_data.h"
#include "check/rules/rules.h"
#include "spirv/source_text.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spv::StorageClass;

// Adds the scalars of a type. Returns false if one of them is no float of 32 bits, or if there are more than two.
bool countFloats(const spirv::Types& types, spirv::Id id, std::uint32_t& count, int depth = 0) {
  using SpirvKind = spirv::Type::Kind;
  const spirv::Type& type = types.get(id);
  if (type.kind == SpirvKind::floating && type.width == 32) return ++count <= 2;
  constexpr int kMaxNested = 4;
  if (depth > kMaxNested) return false;
  const bool elements =
      (type.kind == SpirvKind::vector || type.kind == SpirvKind::array) && type.count > 0 && type.count <= 2;
  for (std::uint32_t i = 0; elements && i < type.count; ++i)
    if (!countFloats(types, type.element, count, depth + 1)) return false;
  if (type.kind != SpirvKind::structure) return elements;
  return std::ranges::all_of(type.members,
                             [&](spirv::Id member) { return countFloats(types, member, count, depth + 1); });
}

// vec2, also in a structure as in HLSL: BuiltInTriangleIntersectionAttributes.
bool isVec2(const spirv::Types& types, spirv::Id id) {
  std::uint32_t count = 0;
  return countFloats(types, id, count) && count == 2;
}

// Q201, Q202: the attribute of the closest-hit and any-hit shader, compared with the one that is written.
void checkTypes(const PipelineGraph& graph, HitGroupRay hit, Report& report) {
  const program::HitShaders& files = graph.shaders(hit);
  const PipelineStage* writer = graph.stage(files.intersection);
  const spirv::SharedVariable* written =
      writer && writer->facts ? writer->facts->incoming(StorageClass::HitAttributeKHR) : nullptr;
  for (const std::string& file : {files.closestHit, files.anyHit}) {
    const PipelineStage* stage = graph.stage(file);
    const spirv::SharedVariable* read =
        stage && stage->facts ? stage->facts->incoming(StorageClass::HitAttributeKHR) : nullptr;
    if (!read) continue;
    const auto& types = stage->facts->module().types();
    if (!graph.groups.groupsKnown && graph.groups.hasIntersections) continue;
    if (files.intersection.empty()) {
      // A group for procedural geometry without an intersection shader is Q601.
      if (!isVec2(types, read->type) && !graph.hasIntersection(hit.group))
        report.add("Q202", graph.location(*stage, read->declaration),
                   fmt::format("hit attribute '{}' is {}, but {} is for triangles, whose attribute is vec2", read->name,
                               types.describe(read->type), graph.describe(hit)),
                   {relatedTo(graph.descriptionLocation(graph.groups.hitGroups[hit.group].line), "the hit group")});
    } else if (written) {
      const auto& writtenTypes = writer->facts->module().types();
      if (const auto difference = spirv::differenceOf(writtenTypes, written->type, types, read->type))
        report.add("Q201", graph.location(*stage, read->declaration),
                   fmt::format("hit attribute '{}' is {} here, but intersection shader '{}' of {} writes {}: {}",
                               read->name, types.describe(read->type), graph.nameOf(files.intersection),
                               graph.describe(hit), writtenTypes.describe(written->type), *difference),
                   {relatedTo(graph.location(*writer, written->declaration), "written here")});
    }
  }
}

void checkSize(const CheckInput& input, const PipelineStage& stage, Report& report) {
  const spirv::SharedVariable* attribute = stage.facts->incoming(StorageClass::HitAttributeKHR);
  if (!attribute) return;
  const auto& types = stage.facts->module().types();
  const std::uint64_t bytes = types.get(attribute->type).bytes;
  if (bytes <= input.limits.maxHitAttributeBytes) return;
  report.add("Q203", input.graph.location(stage, attribute->declaration),
             fmt::format("hit attribute '{}', {}, has {} bytes; {} allows {}", attribute->name,
                         types.describe(attribute->type), bytes,
                         input.limits.name.empty() ? "Vulkan" : input.limits.name, input.limits.maxHitAttributeBytes));
}

constexpr std::string_view kLectureName = "hit";  // starts with zeros and becomes kLectureAttribute

enum class Written { before, after, never };  // the report

// Whether the intersection shader of the lecture form assigns a part of `hit`, from its text: the optimizer removes what
// has no effect. `part` is the outermost member, as ".normal".
Written writtenInLecture(const spirv::Module& module, const std::string& part) {
  for (const auto& [file, text] : module.sources()) {
    const std::size_t main = spirv::findToken(text, "INTERSECTION");
    if (main == text.npos || spirv::findToken(text, "hitAttributeEXT") == text.npos) continue;
    std::size_t report = text.npos;
    for (std::size_t at = spirv::findToken(text, "reportIntersectionEXT", main); at != text.npos;
         at = spirv::findToken(text, "reportIntersectionEXT", at + 1))
      report = at;
    const std::size_t first =
        std::min(spirv::findToken(text, part, main), spirv::findToken(text, fmt::format("{} =", kLectureName), main));
    return first == text.npos                      ? Written::never
           : report != text.npos && first > report ? Written::after
                                                   : Written::before;
  }
  return Written::before;
}

Written written(const spirv::StageFacts& facts, const spirv::SharedVariable* attribute, std::uint32_t leaf) {
  if (!attribute) return Written::never;
  const spirv::Module& module = facts.module();
  std::vector<std::size_t> writers;
  bool zero = attribute->name == kLectureAttribute;
  for (const spirv::AccessFacts& a : facts.accesses()) {
    if (!a.writes || a.variable != attribute->id || !a.leaves.covers(leaf)) continue;
    writers.push_back(a.instruction);
    zero = zero && constantNumber(module, facts.storedValue(a, leaf)) == 0.0;
  }
  if (zero) {
    const spirv::Leaves& leaves = facts.leaves(attribute->id);
    const spirv::LeafRange member = leaves.member(leaf);
    std::vector<std::uint32_t> all;
    for (std::uint32_t i = member.first; i < member.last; ++i) all.push_back(i);
    return writtenInLecture(module, leaves.names(all).front());
  }
  if (writers.empty()) return Written::never;
  for (const spirv::ReportFacts& report : facts.reports())
    for (const std::size_t writer : writers)
      if (spirv::canRunAfter(module, report.instruction, writer)) return Written::before;
  return Written::after;
}

// Q205: the attributes that the closest-hit and any-hit shader read.
void checkWritten(const PipelineGraph& graph, HitGroupRay hit, Report& report) {
  const program::HitShaders& files = graph.shaders(hit);
  const PipelineStage* writer = graph.stage(files.intersection);
  if (!writer || !writer->facts || writer->facts->reports().empty()) return;  // Q206
  const spirv::SharedVariable* attribute = writer->facts->incoming(StorageClass::HitAttributeKHR);
  for (const std::string& file : {files.closestHit, files.anyHit}) {
    const PipelineStage* stage = graph.stage(file);
    const spirv::SharedVariable* read =
        stage && stage->facts ? stage->facts->incoming(StorageClass::HitAttributeKHR) : nullptr;
    if (!read) continue;
    const spirv::StageFacts& facts = *stage->facts;
    if (attribute && differenceOf(writer->facts->module().types(), attribute->type, facts.module().types(), read->type))
      continue;  // Q201
    std::vector<LeafGroup> groups;
    for (std::uint32_t leaf = 0; leaf < facts.leaves(read->id).count(); ++leaf) {
      const std::vector<std::size_t> reads = facts.inputReads(read->id, leaf);
      const Written when = reads.empty() ? Written::before : written(*writer->facts, attribute, leaf);
      if (when == Written::before) continue;
      addTo(
          groups,
          {"hit attribute ",
           fmt::format(" is read here, but intersection shader '{}' of {} {}", files.intersection, graph.describe(hit),
                       when == Written::never ? "never writes it" : "writes it only after it reports the hit"),
           ""},
          leaf, reads.front());
    }
    for (const LeafGroup& group : groups)
      for (const std::string& part : facts.leaves(read->id).names(group.leaves))
        report.addOncePerLine("Q205", graph.location(*stage, locationOf(facts, facts.accesses()[group.read])),
                              group.text.before + nameOf(*read, part) + group.text.after);
  }
}

}  // namespace

void checkHitAttributes(const CheckInput& input, Report& report) {
  const PipelineGraph& graph = input.graph;
  for (std::size_t group = 0; group < graph.groups.hitGroups.size(); ++group)
    for (std::size_t ray = 0; ray < graph.rayCount(); ++ray) {
      checkTypes(graph, {group, ray}, report);
      checkWritten(graph, {group, ray}, report);
    }
  for (const PipelineStage& stage : graph.stages)
    if (stage.facts) checkSize(input, stage, report);
}

}  // namespace quintet::check
