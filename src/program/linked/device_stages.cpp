// SPDX-License-Identifier: Apache-2.0
#include "program/linked/device_stages.h"

#include <algorithm>
#include <utility>

#include "spirv/copy_builtins.h"
#include "spirv/interleave_rows.h"
#include "spirv/module.h"

namespace quintet::program {
VkShaderStageFlagBits vulkanStage(shader::Stage stage) {
  switch (stage) {
    case shader::Stage::rayGeneration: return VK_SHADER_STAGE_RAYGEN_BIT_KHR;
    case shader::Stage::intersection: return VK_SHADER_STAGE_INTERSECTION_BIT_KHR;
    case shader::Stage::anyHit: return VK_SHADER_STAGE_ANY_HIT_BIT_KHR;
    case shader::Stage::closestHit: return VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR;
    case shader::Stage::miss: return VK_SHADER_STAGE_MISS_BIT_KHR;
    case shader::Stage::callable: return VK_SHADER_STAGE_CALLABLE_BIT_KHR;
    case shader::Stage::vertex: return VK_SHADER_STAGE_VERTEX_BIT;
    case shader::Stage::fragment: return VK_SHADER_STAGE_FRAGMENT_BIT;
    case shader::Stage::compute: break;
  }
  return VK_SHADER_STAGE_COMPUTE_BIT;
}

DeviceStages::DeviceStages(const Program& program, const CompiledProgram& compiled, const gpu::Quirks& quirks)
    : compiled_(compiled) {
  own_.reserve(compiled.stages.size());  // stages_ points into its elements
  const bool interleaves =
      quirks.launchParts > 1 && std::ranges::all_of(compiled.stages, [](const CompiledProgram::Stage& stage) {
        return spirv::canInterleaveRows(stage.spirv);
      });
  for (const CompiledProgram::Stage& stage : compiled.stages) {
    std::vector<std::uint32_t>& spirv = own_.emplace_back(spirv::withoutDebugInfo(stage.spirv));
    if (quirks.changesNestedBuiltIns && stage.kind == shader::Stage::closestHit) spirv = spirv::copyBuiltIns(spirv);
    if (interleaves) spirv = spirv::interleaveRows(std::move(spirv), quirks.launchParts);
    stages_.push_back({vulkanStage(stage.kind), spirv, program.path(stage.file)});
  }
}

int DeviceStages::index(const std::string& file) const {
  return file.empty() ? rt::kNoStage : static_cast<int>(&compiled_.stage(file) - compiled_.stages.data());
}

}  // namespace quintet::program
