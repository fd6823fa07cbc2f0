// SPDX-License-Identifier: Apache-2.0
#include "rt/pipeline.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "gpu/error.h"
#include "gpu/pipeline_store.h"

namespace quintet::rt {
namespace {

// One shader module per stage. Modules are only needed while the pipeline is created.
class Modules {
 public:
  Modules(gpu::Context& context, const std::vector<PipelineStage>& stages) : context_(context) {
    try {
      for (const PipelineStage& stage : stages) add(stage);
    } catch (...) {
      release();
      throw;
    }
  }
  ~Modules() { release(); }
  Modules(const Modules&) = delete;
  Modules& operator=(const Modules&) = delete;
  VkShaderModule operator[](std::size_t stage) const { return handles_[stage]; }

 private:
  void add(const PipelineStage& stage) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = stage.spirv.size_bytes();
    info.pCode = stage.spirv.data();
    VkShaderModule handle = VK_NULL_HANDLE;
    gpu::check(context_.vk().vkCreateShaderModule(context_.device(), &info, nullptr, &handle),
               "create the shader module", stage.name);
    handles_.push_back(handle);
    context_.setName(VK_OBJECT_TYPE_SHADER_MODULE, reinterpret_cast<std::uint64_t>(handle), stage.name);
  }
  void release() {
    for (const VkShaderModule handle : handles_)
      context_.vk().vkDestroyShaderModule(context_.device(), handle, nullptr);
  }
  gpu::Context& context_;
  std::vector<VkShaderModule> handles_;
};

// Stage entries and groups. Workaround for Quirks::sharesAnyHit: an intersection shader gets a separate entry for each
// any-hit shader that it is combined with.
class Groups {
 public:
  Groups(const PipelineOptions& options, const Modules& modules, const gpu::Quirks& quirks)
      : options_(options), modules_(modules), splitsIntersections_(quirks.sharesAnyHit) {
    for (const PipelineGroup& group : options.groups) add(group);
  }
  const std::vector<VkPipelineShaderStageCreateInfo>& stages() const { return stages_; }
  const std::vector<VkRayTracingShaderGroupCreateInfoKHR>& groups() const { return groups_; }

 private:
  // Returns the index of the entry of a stage; entries with a different `partner` are separate.
  std::uint32_t entry(int stage, int partner = kNoStage) {
    if (stage == kNoStage) return VK_SHADER_UNUSED_KHR;
    assert(stage >= 0 && static_cast<std::size_t>(stage) < options_.stages.size());
    const auto [known, isNew] = entries_.try_emplace({stage, partner}, static_cast<std::uint32_t>(stages_.size()));
    if (isNew) {
      const auto index = static_cast<std::size_t>(stage);
      VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
      info.stage = options_.stages[index].stage;
      info.module = modules_[index];
      info.pName = "main";
      stages_.push_back(info);
    }
    return known->second;
  }

  void add(const PipelineGroup& group) {
    assert(group.general == kNoStage ||
           (group.closestHit == kNoStage && group.anyHit == kNoStage && group.intersection == kNoStage));
    VkRayTracingShaderGroupCreateInfoKHR info{VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR};
    info.type = group.general != kNoStage        ? VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR
                : group.intersection != kNoStage ? VK_RAY_TRACING_SHADER_GROUP_TYPE_PROCEDURAL_HIT_GROUP_KHR
                                                 : VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR;
    info.generalShader = entry(group.general);
    info.closestHitShader = entry(group.closestHit);
    info.anyHitShader = entry(group.anyHit);
    info.intersectionShader = entry(group.intersection, splitsIntersections_ ? group.anyHit : kNoStage);
    groups_.push_back(info);
  }

  const PipelineOptions& options_;
  const Modules& modules_;
  const bool splitsIntersections_;
  std::map<std::pair<int, int>, std::uint32_t> entries_;
  std::vector<VkPipelineShaderStageCreateInfo> stages_;
  std::vector<VkRayTracingShaderGroupCreateInfoKHR> groups_;
};

void checkOptions(const gpu::RayTracingLimits& limits, const PipelineOptions& options) {
  if (options.maxRecursionDepth > limits.maxRecursionDepth)
    throw UsageError(fmt::format("pipeline '{}' needs a recursion depth of {}; the device supports {}", options.name,
                                 options.maxRecursionDepth, limits.maxRecursionDepth));
  const auto isRayGeneration = [&](const PipelineGroup& group) {
    return group.general != kNoStage &&
           options.stages[static_cast<std::size_t>(group.general)].stage == VK_SHADER_STAGE_RAYGEN_BIT_KHR;
  };
  if (std::ranges::none_of(options.groups, isRayGeneration))
    throw UsageError(fmt::format("pipeline '{}' has no ray generation group", options.name));
}

VkPipeline make(gpu::Context& context, const gpu::BindlessSet& set, const PipelineOptions& options,
                bool keepsStatistics, const gpu::PipelineCache* cache) {
  const Modules modules(context, options.stages);
  const Groups groups(options, modules, context.info().quirks);
  VkRayTracingPipelineCreateInfoKHR info{VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR};
  info.stageCount = static_cast<std::uint32_t>(groups.stages().size());
  info.pStages = groups.stages().data();
  info.groupCount = static_cast<std::uint32_t>(groups.groups().size());
  info.pGroups = groups.groups().data();
  info.maxPipelineRayRecursionDepth = options.maxRecursionDepth;
  info.layout = set.pipelineLayout();
  if (keepsStatistics) info.flags |= VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR;
  VkPipeline pipeline = VK_NULL_HANDLE;
  gpu::check(
      context.vk().vkCreateRayTracingPipelinesKHR(
          context.device(), VK_NULL_HANDLE, cache ? cache->handle() : VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
      "create the ray tracing pipeline", options.name);
  context.setName(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline), options.name);
  return pipeline;
}

// Hash of everything that make() depends on. The layouts of sets are compatible if their push constants have the same
// size.
Hash keyOf(const gpu::BindlessSet& set, const PipelineOptions& options, bool keepsStatistics) {
  Hasher hasher;
  hasher.add("ray tracing").add(set.pushConstantBytes()).add(options.maxRecursionDepth).add(keepsStatistics ? 1u : 0u);
  hasher.add(options.stages.size());
  for (const PipelineStage& stage : options.stages)
    hasher.add(static_cast<std::uint64_t>(stage.stage)).add(stage.spirv.size()).add(std::as_bytes(stage.spirv));
  for (const PipelineGroup& group : options.groups)
    for (const int shader : {group.general, group.closestHit, group.anyHit, group.intersection})
      hasher.add(static_cast<std::uint64_t>(shader + 1));
  return hasher.finish();
}

}  // namespace

Pipeline::Pipeline(gpu::Context& context, const gpu::BindlessSet& set, const PipelineOptions& options,
                   const gpu::PipelineCache* cache)
    : context_(context),
      set_(set),
      groups_(options.groups),
      keepsStatistics_(options.captureStatistics && context.info().pipelineStatistics) {
  const gpu::RayTracingLimits& limits = context.info().limits;
  checkOptions(limits, options);
  key_ = keyOf(set, options, keepsStatistics_);
  handle_ = context.pipelines().acquire(key_, [&] { return make(context, set, options, keepsStatistics_, cache); });
  try {
    handles_.resize(std::size_t{limits.handleSize} * groups_.size());
    gpu::check(
        context.vk().vkGetRayTracingShaderGroupHandlesKHR(
            context.device(), handle_, 0, static_cast<std::uint32_t>(groups_.size()), handles_.size(), handles_.data()),
        "get the shader group handles", options.name);
  } catch (...) {
    context.pipelines().release(key_);
    throw;
  }
}

Pipeline::~Pipeline() { context_.pipelines().release(key_); }

ShaderBindingTable::ShaderBindingTable(gpu::Context& context, const Pipeline& pipeline, const SbtContents& contents,
                                       const std::string& name)
    : layout_(layoutSbt(contents, context.info().limits)) {
  const std::vector<std::byte> bytes = fillSbt(contents, layout_, pipeline.groupHandles(), context.info().limits);
  buffer_ = gpu::Buffer(context, {.size = bytes.size(),
                                  .usage = VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR,
                                  .alignment = context.info().limits.baseAlignment,
                                  .name = name});
  buffer_.upload(bytes);
}

VkStridedDeviceAddressRegionKHR ShaderBindingTable::region(const SbtRegion& region) const {
  if (region.size == 0) return {};
  return {buffer_.address() + region.offset, region.stride, region.size};
}

namespace {

void recordTrace(gpu::Commands& commands, const Pipeline& pipeline, const ShaderBindingTable& table,
                 std::span<const std::byte> constants, std::uint32_t width, std::uint32_t height, std::uint32_t depth) {
  assert(constants.size() <= pipeline.set().pushConstantBytes());

  const VolkDeviceTable& vk = commands.context().vk();
  const gpu::BindlessSet& set = pipeline.set();
  const VkDescriptorSet descriptors = set.set();
  vk.vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, pipeline.handle());
  vk.vkCmdBindDescriptorSets(commands.handle(), VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, set.pipelineLayout(), 0, 1,
                             &descriptors, 0, nullptr);
  if (!constants.empty())
    vk.vkCmdPushConstants(commands.handle(), set.pipelineLayout(), gpu::BindlessSet::stages(), 0,
                          static_cast<std::uint32_t>(constants.size()), constants.data());
  const SbtLayout& layout = table.layout();
  const VkStridedDeviceAddressRegionKHR rayGeneration = table.region(layout.rayGeneration),
                                        miss = table.region(layout.miss), hit = table.region(layout.hit),
                                        callable = table.region(layout.callable);
  vk.vkCmdTraceRaysKHR(commands.handle(), &rayGeneration, &miss, &hit, &callable, width, height, depth);
}

}  // namespace

void trace(gpu::Commands& commands, const Pipeline& pipeline, const ShaderBindingTable& table,
           std::span<const std::byte> constants, std::uint32_t width, std::uint32_t height, std::uint32_t depth) {
  gpu::Context& context = commands.context();
  const std::uint64_t limit = context.info().limits.maxLaunchInvocations;
  const std::uint64_t plane = std::uint64_t{width} * height;
  if (plane > limit || plane * depth > limit)
    throw UsageError(fmt::format("a launch of {} x {} x {} rays is too large; the device supports {} rays", width,
                                 height, depth, limit));
  if (plane * depth == 0) return;
  recordTrace(commands, pipeline, table, constants, width, height, depth);
}

void traceNothing(gpu::Commands& commands, const Pipeline& pipeline, const ShaderBindingTable& table) {
  const std::vector<std::byte> constants(pipeline.set().pushConstantBytes());
  recordTrace(commands, pipeline, table, constants, 0, 0, 0);
}

namespace {

double asNumber(const VkPipelineExecutableStatisticKHR& statistic) {
  switch (statistic.format) {
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_BOOL32_KHR: return statistic.value.b32 ? 1.0 : 0.0;
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_INT64_KHR: return static_cast<double>(statistic.value.i64);
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_UINT64_KHR: return static_cast<double>(statistic.value.u64);
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_FLOAT64_KHR: return statistic.value.f64;
    default: return 0.0;
  }
}

std::vector<VkPipelineExecutableStatisticKHR> statisticsOf(const gpu::Context& context, VkPipeline pipeline,
                                                           std::uint32_t executable) {
  VkPipelineExecutableInfoKHR info{VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR};
  info.pipeline = pipeline;
  info.executableIndex = executable;
  std::uint32_t count = 0;
  gpu::check(context.vk().vkGetPipelineExecutableStatisticsKHR(context.device(), &info, &count, nullptr),
             "count a pipeline's statistics");
  std::vector<VkPipelineExecutableStatisticKHR> statistics(count,
                                                           {VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR});
  gpu::check(context.vk().vkGetPipelineExecutableStatisticsKHR(context.device(), &info, &count, statistics.data()),
             "get a pipeline's statistics");
  return statistics;
}

}  // namespace

std::vector<PipelineExecutable> pipelineStatistics(const Pipeline& pipeline) {
  const gpu::Context& context = pipeline.context();
  if (!pipeline.keepsStatistics()) return {};
  VkPipelineInfoKHR info{VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR};
  info.pipeline = pipeline.handle();
  std::uint32_t count = 0;
  gpu::check(context.vk().vkGetPipelineExecutablePropertiesKHR(context.device(), &info, &count, nullptr),
             "count a pipeline's executables");
  std::vector<VkPipelineExecutablePropertiesKHR> properties(count,
                                                            {VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR});
  gpu::check(context.vk().vkGetPipelineExecutablePropertiesKHR(context.device(), &info, &count, properties.data()),
             "list a pipeline's executables");
  std::vector<PipelineExecutable> executables;
  for (std::uint32_t i = 0; i < count; ++i) {
    PipelineExecutable& executable = executables.emplace_back();
    executable.name = properties[i].name;
    executable.subgroupSize = properties[i].subgroupSize;
    for (const VkPipelineExecutableStatisticKHR& statistic : statisticsOf(context, pipeline.handle(), i))
      executable.statistics.emplace_back(statistic.name, asNumber(statistic));
  }
  return executables;
}

std::vector<std::pair<std::string, std::uint64_t>> groupStackSizes(const Pipeline& pipeline) {
  const gpu::Context& context = pipeline.context();
  std::vector<std::pair<std::string, std::uint64_t>> sizes;
  for (std::uint32_t i = 0; i < pipeline.groups().size(); ++i) {
    const PipelineGroup& group = pipeline.groups()[i];
    std::uint64_t size = 0;
    const auto addStage = [&](int stage, VkShaderGroupShaderKHR shader) {
      if (stage != kNoStage)
        size = std::max<std::uint64_t>(
            size, context.vk().vkGetRayTracingShaderGroupStackSizeKHR(context.device(), pipeline.handle(), i, shader));
    };
    addStage(group.general, VK_SHADER_GROUP_SHADER_GENERAL_KHR);
    addStage(group.closestHit, VK_SHADER_GROUP_SHADER_CLOSEST_HIT_KHR);
    addStage(group.anyHit, VK_SHADER_GROUP_SHADER_ANY_HIT_KHR);
    addStage(group.intersection, VK_SHADER_GROUP_SHADER_INTERSECTION_KHR);
    sizes.emplace_back(group.name, size);
  }
  return sizes;
}

}  // namespace quintet::rt
