// SPDX-License-Identifier: Apache-2.0
#include "stage_modules.h"

#include <fmt/format.h>

#include <atomic>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "base/hash.h"
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

Hash keyOf(const StageCopy& stage) {
  Hasher hasher;
  hasher.add(std::as_bytes(std::span(*stage.words))).add(stage.stage).add(stage.entryPoint).add(stage.values.size());
  const std::map<std::uint32_t, std::vector<std::uint32_t>> values(stage.values.begin(), stage.values.end());
  for (const auto& [id, words] : values) hasher.add(id).add(std::as_bytes(std::span(words)));
  return hasher.finish();
}

CachedStage prepare(const StageCopy& stage) {
  CachedStage prepared;
  prepared.module = check::stageModule("", *stage.words, {modelOf(stage.stage), stage.entryPoint}, stage.values);
  if (const auto read = spirv::Module::read(prepared.module.spirv)) {
    prepared.recordBytes = spirv::shaderRecordBytes(*read);
    prepared.indexByRecord = spirv::indexesByRecord(*read);
  }
  return prepared;
}

}  // namespace

StageModules modulesOf(const std::vector<StageCopy>& stages, ModuleCache& cache, const ParallelLoop& loop) {
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
  loop(result.modules.size(), [&](std::size_t i) {
    const StageCopy& stage = stages[firstStage[i]];
    check::ModuleStage& module = result.modules[i];
    if (!sourceOf[i]->summary) {
      module = {module.name, *check::stageOf(modelOf(stage.stage)), {}, sourceOf[i]->problem};
      return;
    }
    const Hash key = keyOf(stage);
    std::optional<CachedStage> prepared = cache.find(key);
    if (!prepared) cache.add(key, *(prepared = prepare(stage)));
    prepared->module.name = module.name;
    module = std::move(prepared->module);
    result.recordBytes[i] = prepared->recordBytes;
    if (prepared->indexByRecord) indexByRecord = true;
  });
  result.indexByRecord = indexByRecord;
  return result;
}

}  // namespace quintet::layer
