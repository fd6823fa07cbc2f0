// SPDX-License-Identifier: Apache-2.0
// Q201 to Q203: type and size of hit attributes.
#include <fmt/format.h>

#include "check/rules/rules.h"

namespace quintet::check {
namespace {

using spv::StorageClass;

bool isVec2(const spirv::Types& types, spirv::Id id) {
  const spirv::Type& type = types.get(id);
  return type.kind == spirv::Type::Kind::vector && type.count == 2 &&
         types.get(type.element).kind == spirv::Type::Kind::floating && types.get(type.element).width == 32;
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
    if (files.intersection.empty()) {
      // A group for procedural geometry without an intersection shader is Q601.
      if (!isVec2(types, read->type) && !graph.hasIntersection(hit.group))
        report.add("Q202", graph.location(*stage, read->declaration),
                   fmt::format("hit attribute '{}' is {}, but {} is for triangles, whose attribute is vec2", read->name,
                               types.describe(read->type), graph.describe(hit)),
                   {relatedTo(graph.descriptionLocation(graph.program.hitGroups[hit.group].line), "the hit group")});
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

}  // namespace

void checkHitAttributes(const CheckInput& input, Report& report) {
  const PipelineGraph& graph = input.graph;
  for (std::size_t group = 0; group < graph.program.hitGroups.size(); ++group)
    for (std::size_t ray = 0; ray < graph.rayCount(); ++ray) checkTypes(graph, {group, ray}, report);
  for (const PipelineStage& stage : graph.stages)
    if (stage.facts) checkSize(input, stage, report);
}

}  // namespace quintet::check
