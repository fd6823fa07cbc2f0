// Q201 ... Q203: hit attributes.
#include <fmt/format.h>

#include "program/check_parts.h"

namespace quintet::program {
namespace {

using shader::SharedVariable;
using shader::StageFacts;
using spv::StorageClass;

bool isVec2(const shader::SpirvTypes& types, shader::SpirvId id) {
  const shader::SpirvType& type = types.get(id);
  return type.kind == shader::SpirvType::Kind::vector && type.count == 2 &&
         types.get(type.element).kind == shader::SpirvType::Kind::real && types.get(type.element).width == 32;
}

void checkRow(const LinkModel& model, HitRow row, Report& report) {
  const HitShaders& files = model.shaders(row);
  const StageFacts* intersection = model.facts(files.intersection);
  const SharedVariable* written = intersection ? intersection->incoming(StorageClass::HitAttributeKHR) : nullptr;
  for (const std::string& file : {files.closestHit, files.anyHit}) {
    const LinkStage* stage = model.stage(file);
    const SharedVariable* read =
        stage && stage->facts ? stage->facts->incoming(StorageClass::HitAttributeKHR) : nullptr;
    if (!read) continue;
    const auto& types = stage->facts->module().types();
    if (files.intersection.empty()) {
      // A group for boxes without intersection shader is Q601.
      if (!isVec2(types, read->type) && !model.hasIntersection(row.group))
        report.add("Q202", model.at(*stage, read->place),
                   fmt::format("hit attribute '{}' is {}, but {} is for triangles, whose attribute is vec2", read->name,
                               types.describe(read->type), model.describe(row)));
    } else if (written) {
      const auto& writtenTypes = intersection->module().types();
      if (const auto difference = shader::differenceOf(writtenTypes, written->type, types, read->type))
        report.add("Q201", model.at(*stage, read->place),
                   fmt::format("hit attribute '{}' is {} here, but the intersection shader '{}' of {} writes {}: {}",
                               read->name, types.describe(read->type), files.intersection, model.describe(row),
                               writtenTypes.describe(written->type), *difference));
    }
  }
}

}  // namespace

void checkHitAttributes(const CheckInput& input, Report& report) {
  const LinkModel& model = input.model;
  for (std::size_t group = 0; group < model.program.hitGroups.size(); ++group)
    for (std::size_t ray = 0; ray < model.rayCount(); ++ray) checkRow(model, {group, ray}, report);
  for (const LinkStage& stage : model.stages) {
    const SharedVariable* attribute = stage.facts ? stage.facts->incoming(StorageClass::HitAttributeKHR) : nullptr;
    if (!attribute) continue;
    const auto& types = stage.facts->module().types();
    const std::uint64_t bytes = types.get(attribute->type).bytes;
    if (bytes > input.limits.maxHitAttributeBytes)
      report.add(
          "Q203", model.at(stage, attribute->place),
          fmt::format("hit attribute '{}', {}, has {} bytes; {} allows {}", attribute->name,
                      types.describe(attribute->type), bytes, input.limits.name.empty() ? "Vulkan" : input.limits.name,
                      input.limits.maxHitAttributeBytes));
  }
}

}  // namespace quintet::program
