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

VkShaderStageFlagBits stageBit(shader::Stage stage) {
  switch (stage) {
    case shader::Stage::rayGeneration: return VK_SHADER_STAGE_RAYGEN_BIT_KHR;
    case shader::Stage::intersection: return VK_SHADER_STAGE_INTERSECTION_BIT_KHR;
    case shader::Stage::anyHit: return VK_SHADER_STAGE_ANY_HIT_BIT_KHR;
    case shader::Stage::closestHit: return VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR;
    case shader::Stage::miss: return VK_SHADER_STAGE_MISS_BIT_KHR;
    case shader::Stage::callable: return VK_SHADER_STAGE_CALLABLE_BIT_KHR;
    case shader::Stage::compute: break;
  }
  assert(false && "not a ray tracing stage");
  return VK_SHADER_STAGE_RAYGEN_BIT_KHR;
}

// One shader module per stage; needed only while the pipeline is made.
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

// Stage entries and groups. An intersection shader gets an entry for each any-hit shader that it is
// combined with: lavapipe (Mesa 25.0) calls the first group's any-hit shader for all groups that share
// one intersection entry. Test: RtPipeline.GroupsShareAnIntersectionShader.
class Groups {
 public:
  Groups(const PipelineOptions& options, const Modules& modules) : options_(options), modules_(modules) {
    for (const PipelineGroup& group : options.groups) add(group);
  }
  const std::vector<VkPipelineShaderStageCreateInfo>& stages() const { return stages_; }
  const std::vector<VkRayTracingShaderGroupCreateInfoKHR>& groups() const { return groups_; }

 private:
  std::uint32_t entry(int stage, int partner = kNoStage) {
    if (stage == kNoStage) return VK_SHADER_UNUSED_KHR;
    assert(stage >= 0 && static_cast<std::size_t>(stage) < options_.stages.size());
    const auto [known, isNew] = entries_.try_emplace({stage, partner}, static_cast<std::uint32_t>(stages_.size()));
    if (isNew) {
      const auto index = static_cast<std::size_t>(stage);
      VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
      info.stage = stageBit(options_.stages[index].stage);
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
    info.intersectionShader = entry(group.intersection, group.anyHit);
    groups_.push_back(info);
  }

  const PipelineOptions& options_;
  const Modules& modules_;
  std::map<std::pair<int, int>, std::uint32_t> entries_;
  std::vector<VkPipelineShaderStageCreateInfo> stages_;
  std::vector<VkRayTracingShaderGroupCreateInfoKHR> groups_;
};

void checkOptions(const gpu::RayTracingLimits& limits, const PipelineOptions& options) {
  if (options.maxRecursionDepth > limits.maxRecursionDepth)
    throw UsageError(fmt::format("pipeline '{}' needs a recursion depth of {}, the device allows {}", options.name,
                                 options.maxRecursionDepth, limits.maxRecursionDepth));
  const auto isRayGeneration = [&](const PipelineGroup& group) {
    return group.general != kNoStage &&
           options.stages[static_cast<std::size_t>(group.general)].stage == shader::Stage::rayGeneration;
  };
  if (std::ranges::none_of(options.groups, isRayGeneration))
    throw UsageError(fmt::format("pipeline '{}' has no ray generation group", options.name));
}

VkPipeline make(gpu::Context& context, const gpu::BindlessSet& set, const PipelineOptions& options,
                bool keepsStatistics, const gpu::PipelineCache* cache) {
  const Modules modules(context, options.stages);
  const Groups groups(options, modules);
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

// All that make() depends on; the layouts of all sets are compatible if their push constants are as large.
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
    context.pipelines().release(context, key_);
    throw;
  }
}

Pipeline::~Pipeline() { context_.pipelines().release(context_, key_); }

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

void trace(gpu::Commands& commands, const Pipeline& pipeline, const ShaderBindingTable& table,
           std::span<const std::byte> constants, std::uint32_t width, std::uint32_t height, std::uint32_t depth) {
  gpu::Context& context = commands.context();
  const std::uint64_t limit = context.info().limits.maxLaunchInvocations;
  const std::uint64_t plane = std::uint64_t{width} * height;
  if (plane > limit || plane * depth > limit)
    throw UsageError(fmt::format("a launch of {} x {} x {} rays: the device allows {}", width, height, depth, limit));
  if (plane * depth == 0) return;
  assert(constants.size() <= pipeline.set().pushConstantBytes());

  const VolkDeviceTable& vk = context.vk();
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

}  // namespace quintet::rt
