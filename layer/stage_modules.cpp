// SPDX-License-Identifier: Apache-2.0
#include "stage_modules.h"

#include <fmt/format.h>

#include <atomic>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "device.h"
#include "spirv/shader_record.h"

namespace quintet::layer {
namespace {

struct LessWords {
  bool operator()(const Words& a, const Words& b) const { return a != b && *a < *b; }
};

// SPIR-V that one or more stages use.
struct Source {
  std::optional<check::ModuleSummary> summary;
  std::string problem = {};  // why there is no summary
};

spv::ExecutionModel modelOf(VkShaderStageFlagBits stage) {
  using Model = spv::ExecutionModel;
  switch (stage) {
    case VK_SHADER_STAGE_RAYGEN_BIT_KHR: return Model::RayGenerationKHR;
    case VK_SHADER_STAGE_MISS_BIT_KHR: return Model::MissKHR;
    case VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR: return Model::ClosestHitKHR;
    case VK_SHADER_STAGE_ANY_HIT_BIT_KHR: return Model::AnyHitKHR;
    case VK_SHADER_STAGE_INTERSECTION_BIT_KHR: return Model::IntersectionKHR;
    default: return Model::CallableKHR;
  }
}

// The name of a module as the application or its source gives it, or the index of its first stage.
std::string nameOf(const StageCopy& stage, std::size_t index, const Source& source) {
  std::string name = stage.name;
  if (name.empty() && source.summary && source.summary->sources.size() == 1)
    name = source.summary->sources.begin()->first;
  if (name.empty()) name = fmt::format("stage {}", index);
  if (stage.entryPoint != "main") name += fmt::format(" ({})", stage.entryPoint);
  return name;
}

}  // namespace

StageModules modulesOf(const std::vector<StageCopy>& stages) {
  using Constants = std::map<std::uint32_t, std::vector<std::uint32_t>>;
  StageModules result;
  const Source unknown{{}, "its SPIR-V is unknown"};
  std::map<Words, Source, LessWords> sources;
  std::map<std::tuple<const Source*, VkShaderStageFlagBits, std::string, Constants>, std::size_t> known;
  std::vector<std::size_t> firstStage;  // by module
  std::vector<const Source*> sourceOf;
  std::set<std::string> names;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const StageCopy& stage = stages[i];
    const Source* source = &unknown;
    if (stage.words) {
      const auto [found, isNew] = sources.try_emplace(stage.words);
      source = &found->second;
      if (isNew) found->second.summary = check::summarize(*stage.words, found->second.problem);
      const auto [module, isNewModule] = known.try_emplace(
          {source, stage.stage, stage.entryPoint, Constants(stage.values.begin(), stage.values.end())},
          result.modules.size());
      if (!isNewModule) {
        result.ofStage.push_back(module->second);
        continue;
      }
    }
    result.ofStage.push_back(result.modules.size());
    check::ModuleStage& module = result.modules.emplace_back();
    module.name = nameOf(stage, i, *source);
    // Two modules can be the same entry point with different constants.
    if (!names.insert(module.name).second) names.insert(module.name += fmt::format(" (stage {})", i));
    firstStage.push_back(i);
    sourceOf.push_back(source);
    if (source->summary) result.sources.insert(source->summary->sources.begin(), source->summary->sources.end());
  }
  result.recordBytes.resize(result.modules.size());
  std::atomic<bool> indexByRecord = false;
  parallelFor(result.modules.size(), [&](std::size_t i) {
    const StageCopy& stage = stages[firstStage[i]];
    check::ModuleStage& module = result.modules[i];
    const spv::ExecutionModel model = modelOf(stage.stage);
    if (sourceOf[i]->summary)
      module = check::stageModule(module.name, *stage.words, {model, stage.entryPoint}, stage.values);
    else
      module = {module.name, *check::stageOf(model), {}, sourceOf[i]->problem};
    if (const auto read = spirv::Module::read(module.spirv)) {
      result.recordBytes[i] = spirv::shaderRecordBytes(*read);
      if (spirv::indexesByRecord(*read)) indexByRecord = true;
    }
  });
  result.indexByRecord = indexByRecord;
  return result;
}

}  // namespace quintet::layer
