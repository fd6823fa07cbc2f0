// SPDX-License-Identifier: Apache-2.0
#include "device.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "chains.h"
#include "check/modules/stack_check.h"
#include "check/suppression.h"

namespace quintet::layer {
namespace {

Words wordsOf(const VkShaderModuleCreateInfo& info) {
  if (!info.pCode) return nullptr;
  return std::make_shared<const std::vector<std::uint32_t>>(info.pCode, info.pCode + info.codeSize / 4);
}

shader::SpecializationValues valuesOf(const VkSpecializationInfo* info) {
  shader::SpecializationValues values;
  if (!info || !info->pData) return values;
  for (std::uint32_t i = 0; i < info->mapEntryCount; ++i) {
    const VkSpecializationMapEntry& entry = info->pMapEntries[i];
    if (entry.offset > info->dataSize || entry.size > info->dataSize - entry.offset || entry.size > 8) continue;
    std::vector<std::uint32_t> words(entry.size > 4 ? 2 : 1);
    std::memcpy(words.data(), static_cast<const std::byte*>(info->pData) + entry.offset, entry.size);
    values[entry.constantID] = std::move(words);
  }
  return values;
}

std::string identifierOf(const std::uint8_t* bytes, std::uint32_t count) {
  return bytes ? std::string(bytes, bytes + count) : std::string();
}

std::optional<std::size_t> indexOf(std::uint32_t stage, std::size_t first, std::size_t count) {
  return stage == VK_SHADER_UNUSED_KHR || stage >= count ? std::nullopt : std::optional(first + stage);
}

}  // namespace

Device::Device(VkDevice device, VkPhysicalDevice physical, PFN_vkGetDeviceProcAddr nextLayer,
               std::shared_ptr<Instance> owner)
    : handle(device), next(nextLayer), instance(std::move(owner)) {
#define QUINTET_LOAD(name) table.name = reinterpret_cast<PFN_vk##name>(next(handle, "vk" #name));
  QUINTET_DEVICE_FUNCTIONS(QUINTET_LOAD)
#undef QUINTET_LOAD
  if (!table.QueueSubmit2) table.QueueSubmit2 = reinterpret_cast<PFN_vkQueueSubmit2>(next(handle, "vkQueueSubmit2KHR"));
  for (const char* name : {"vkCmdBindDescriptorSets2KHR", "vkCmdBindDescriptorSets2"})
    if (const auto found = next(handle, name))
      cmdBindDescriptorSets2 = reinterpret_cast<decltype(cmdBindDescriptorSets2)>(found);
  if (!table.GetDeviceBufferMemoryRequirements)
    table.GetDeviceBufferMemoryRequirements = reinterpret_cast<PFN_vkGetDeviceBufferMemoryRequirements>(
        next(handle, "vkGetDeviceBufferMemoryRequirementsKHR"));
  if (!table.GetBufferDeviceAddress)
    table.GetBufferDeviceAddress =
        reinterpret_cast<PFN_vkGetBufferDeviceAddress>(next(handle, "vkGetBufferDeviceAddressKHR"));
  VkPhysicalDeviceRayTracingPipelinePropertiesKHR rays{};
  rays.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR;
  VkPhysicalDeviceProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  properties.pNext = &rays;
  if (instance->table.GetPhysicalDeviceProperties2) instance->table.GetPhysicalDeviceProperties2(physical, &properties);
  if (instance->table.GetPhysicalDeviceMemoryProperties)
    instance->table.GetPhysicalDeviceMemoryProperties(physical, &memory);
  if (rays.shaderGroupHandleSize == 0) return;
  tableLimits = {rays.shaderGroupHandleSize, rays.shaderGroupHandleAlignment, rays.shaderGroupBaseAlignment,
                 rays.maxShaderGroupStride};
  limits.name = properties.properties.deviceName;
  limits.maxRecursion = rays.maxRayRecursionDepth;
  limits.maxHitAttributeBytes = rays.maxRayHitAttributeSize;
}

Device::~Device() { instance->worker.waitForAll(); }

void Device::addModule(VkShaderModule module, const VkShaderModuleCreateInfo& info) {
  Words words = wordsOf(info);
  const std::scoped_lock lock(mutex_);
  modules_[module] = std::move(words);
}

void Device::removeModule(VkShaderModule module) {
  const std::scoped_lock lock(mutex_);
  modules_.erase(module);
  names_.erase({VK_OBJECT_TYPE_SHADER_MODULE, numberOf(module)});
}

void Device::addIdentifier(VkShaderModule module, const VkShaderModuleIdentifierEXT& identifier) {
  const std::scoped_lock lock(mutex_);
  if (const auto found = modules_.find(module); found != modules_.end())
    identifiers_[identifierOf(identifier.identifier, identifier.identifierSize)] = found->second;
}

void Device::addIdentifier(const VkShaderModuleCreateInfo& info, const VkShaderModuleIdentifierEXT& identifier) {
  Words words = wordsOf(info);
  const std::scoped_lock lock(mutex_);
  identifiers_[identifierOf(identifier.identifier, identifier.identifierSize)] = std::move(words);
}

void Device::setName(VkObjectType type, std::uint64_t object, const char* name) {
  if (type != VK_OBJECT_TYPE_PIPELINE && type != VK_OBJECT_TYPE_SHADER_MODULE) return;
  const std::scoped_lock lock(mutex_);
  if (name && *name)
    names_[{type, object}] = name;
  else
    names_.erase({type, object});
}

std::string Device::nameOf(VkObjectType type, std::uint64_t object) {
  const std::scoped_lock lock(mutex_);
  const auto found = names_.find({type, object});
  return found == names_.end() ? std::string() : found->second;
}

std::vector<PipelineCopy> Device::copy(std::uint32_t count, const VkRayTracingPipelineCreateInfoKHR* infos) {
  std::vector<PipelineCopy> copies(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const VkRayTracingPipelineCreateInfoKHR& info = infos[i];
    PipelineCopy& copy = copies[i];
    copy.depth = info.maxPipelineRayRecursionDepth;
    copy.descriptors = descriptors.countsOf(info.layout);
    const auto* flags = findInChain<Flags2>(info.pNext, kPipelineFlags2);
    copy.isLibrary = ((flags ? flags->flags : info.flags) & VK_PIPELINE_CREATE_LIBRARY_BIT_KHR) != 0;
    copy.stages.reserve(info.stageCount);
    copy.groups.reserve(info.groupCount);
    const std::scoped_lock lock(mutex_);
    for (std::uint32_t s = 0; s < info.stageCount; ++s) {
      const VkPipelineShaderStageCreateInfo& stage = info.pStages[s];
      StageCopy added{
          nullptr, {}, stage.stage, stage.pName ? stage.pName : "main", valuesOf(stage.pSpecializationInfo)};
      if (const auto found = modules_.find(stage.module); found != modules_.end()) {
        added.words = found->second;
        const auto name = names_.find({VK_OBJECT_TYPE_SHADER_MODULE, numberOf(stage.module)});
        if (name != names_.end()) added.name = name->second;
      } else if (const auto* module =
                     findInChain<VkShaderModuleCreateInfo>(stage.pNext, VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO)) {
        added.words = wordsOf(*module);
      } else if (const auto* identifier = findInChain<VkPipelineShaderStageModuleIdentifierCreateInfoEXT>(
                     stage.pNext, VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_MODULE_IDENTIFIER_CREATE_INFO_EXT)) {
        const auto known = identifiers_.find(identifierOf(identifier->pIdentifier, identifier->identifierSize));
        if (known != identifiers_.end()) added.words = known->second;
      }
      copy.stages.push_back(std::move(added));
    }
    for (std::uint32_t g = 0; g < info.groupCount; ++g) {
      const VkRayTracingShaderGroupCreateInfoKHR& group = info.pGroups[g];
      const auto index = [&](std::uint32_t stage) { return indexOf(stage, 0, info.stageCount); };
      if (group.type == VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR)
        copy.groups.push_back({group.type, index(group.generalShader), {}, {}, {}});
      else
        copy.groups.push_back({group.type,
                               {},
                               index(group.closestHitShader),
                               index(group.anyHitShader),
                               index(group.intersectionShader)});
    }
    // The groups of libraries follow, in the order of the libraries.
    for (std::uint32_t l = 0; info.pLibraryInfo && l < info.pLibraryInfo->libraryCount; ++l) {
      const auto library = pipelines_.find(info.pLibraryInfo->pLibraries[l]);
      if (library == pipelines_.end()) {
        copy.isComplete = false;
        continue;
      }
      const PipelineCopy& from = library->second->copy;
      copy.isComplete = copy.isComplete && from.isComplete;
      for (const auto& [slot, length] : from.descriptors)
        copy.descriptors[slot] = std::max(copy.descriptors[slot], length);
      const std::size_t first = copy.stages.size();
      copy.stages.insert(copy.stages.end(), from.stages.begin(), from.stages.end());
      for (GroupCopy group : from.groups) {
        for (auto* stage : {&group.general, &group.closestHit, &group.anyHit, &group.intersection})
          if (*stage) **stage += first;
        copy.groups.push_back(group);
      }
    }
  }
  return copies;
}

void Device::addPipelines(std::vector<PipelineCopy> copies, const VkPipeline* pipelines) {
  std::vector<std::shared_ptr<LinkedPipeline>> added;
  for (std::size_t i = 0; i < copies.size(); ++i) {
    if (pipelines[i] == VK_NULL_HANDLE) continue;
    auto pipeline = std::make_shared<LinkedPipeline>();
    pipeline->copy = std::move(copies[i]);
    pipeline->handle = pipelines[i];
    if (!pipeline->copy.isLibrary && pipeline->copy.isComplete) {
      const auto check = [this, pipeline] {
        try {
          link(*pipeline);
        } catch (const std::exception& error) {  // of the host, such as std::bad_alloc
          Diagnostic d;
          d.severity = Severity::note;
          d.text = fmt::format("the pipeline is not checked: {}", error.what());
          pipeline->result.diagnostics = {d};
        }
      };
      pipeline->task = instance->settings.wait ? instance->worker.runNow(check) : instance->worker.add(check);
    }
    const std::scoped_lock lock(mutex_);
    pipelines_[pipelines[i]] = pipeline;
    if (pipeline->task) undelivered_ = true;
    added.push_back(std::move(pipeline));
  }
  if (instance->settings.wait)
    for (const auto& pipeline : added) deliver(*pipeline);
}

void Device::defer(VkDeferredOperationKHR operation, std::vector<PipelineCopy> copies, const VkPipeline* pipelines) {
  const std::scoped_lock lock(mutex_);
  deferred_[operation] = {std::move(copies), pipelines};
}

void Device::completeDeferred(VkDeferredOperationKHR operation) {
  Deferred deferred;
  {
    const std::scoped_lock lock(mutex_);
    const auto found = deferred_.find(operation);
    if (found == deferred_.end()) return;
    deferred = std::move(found->second);
    deferred_.erase(found);
  }
  addPipelines(std::move(deferred.copies), deferred.pipelines);
}

void Device::cancelDeferred(VkDeferredOperationKHR operation) {
  const std::scoped_lock lock(mutex_);
  deferred_.erase(operation);
}

void Device::removePipeline(VkPipeline object) {
  if (const auto removed = pipeline(object)) deliver(*removed);
  const std::scoped_lock lock(mutex_);
  pipelines_.erase(object);
  names_.erase({VK_OBJECT_TYPE_PIPELINE, numberOf(object)});
}

std::shared_ptr<LinkedPipeline> Device::pipeline(VkPipeline object) {
  const std::scoped_lock lock(mutex_);
  const auto found = pipelines_.find(object);
  return found == pipelines_.end() ? nullptr : found->second;
}

void Device::bind(VkCommandBuffer commands, VkPipeline object) {
  const std::shared_ptr<LinkedPipeline> bound = pipeline(object);
  if (!bound) return;
  deliver(*bound);
  const std::scoped_lock lock(mutex_);
  bound_[commands] = bound;
}

std::shared_ptr<LinkedPipeline> Device::boundPipeline(VkCommandBuffer commands) {
  const std::scoped_lock lock(mutex_);
  const auto found = bound_.find(commands);
  return found == bound_.end() ? nullptr : found->second;
}

void Device::forgetCommands(VkCommandBuffer commands) {
  const std::scoped_lock lock(mutex_);
  bound_.erase(commands);
}

void Device::deliver(LinkedPipeline& pipeline) {
  if (!pipeline.task) return;
  instance->worker.wait(pipeline.task);
  {
    const std::scoped_lock lock(pipeline.mutex);
    if (pipeline.delivered) return;
    pipeline.delivered = true;
  }
  report(pipeline.result.diagnostics, pipeline);
}

void Device::deliverFinished() {
  if (!undelivered_) return;
  std::vector<std::shared_ptr<LinkedPipeline>> finished;
  {
    const std::scoped_lock lock(mutex_);
    bool open = false;
    for (const auto& [object, pipeline] : pipelines_) {
      if (!pipeline->task) continue;
      const std::scoped_lock ofPipeline(pipeline->mutex);
      if (pipeline->delivered) continue;
      if (instance->worker.isDone(*pipeline->task))
        finished.push_back(pipeline);
      else
        open = true;
    }
    undelivered_ = open;
  }
  for (const auto& pipeline : finished) deliver(*pipeline);
}

void Device::deliverAll() {
  instance->worker.waitForAll();
  deliverFinished();
}

void Device::report(std::vector<Diagnostic> diagnostics, LinkedPipeline& pipeline) {
  const MessageObject object{VK_OBJECT_TYPE_PIPELINE, numberOf(pipeline.handle),
                             nameOf(VK_OBJECT_TYPE_PIPELINE, numberOf(pipeline.handle))};
  instance->messages.report(diagnostics, object, pipeline.stages.sources);
}

// Runs on the worker's thread.
void Device::link(LinkedPipeline& pipeline) {
  const PipelineCopy& copy = pipeline.copy;
  pipeline.stages = modulesOf(copy.stages, cache_,
                              [this](std::size_t count, const auto& body) { instance->worker.loop(count, body); });
  std::vector<Diagnostic> notes;
  for (const check::ModuleStage& module : pipeline.stages.modules) {
    if (module.problem.empty()) continue;
    Diagnostic d;
    d.severity = Severity::note;
    d.file = module.name;
    d.text = "not checked: " + module.problem;
    notes.push_back(std::move(d));
  }
  check::PipelineGroups& groups = pipeline.groups;
  groups.noun = "pipeline";
  groups.rays = {""};
  groups.hitRecords = check::HitRecords::byRecord;
  groups.tablesKnown = false;
  groups.declaredRecursion = std::max(1u, copy.depth);
  groups.descriptorCounts = copy.descriptors;
  for (std::size_t g = 0; g < copy.groups.size(); ++g) {
    const GroupCopy& group = copy.groups[g];
    const auto nameAt = [&](const std::optional<std::size_t>& stage) {
      return stage ? pipeline.stages.of(*stage).name : std::string();
    };
    if (group.type != VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR) {
      program::HitGroup hit;
      hit.name = std::to_string(g);
      hit.shaders[""] = {nameAt(group.closestHit), nameAt(group.anyHit), nameAt(group.intersection), {}, 0};
      groups.hitGroups.push_back(std::move(hit));
    } else if (group.general) {
      const std::string& name = pipeline.stages.of(*group.general).name;
      switch (copy.stages[*group.general].stage) {
        case VK_SHADER_STAGE_RAYGEN_BIT_KHR: groups.rayGenerations.push_back(name); break;
        case VK_SHADER_STAGE_MISS_BIT_KHR: groups.misses.push_back({{}, name, {}, 0}); break;
        default: groups.callables.push_back({{}, name, {}, 0});
      }
    }
  }
  pipeline.result = check::checkModules(check::withoutRepeatedGroups(groups), pipeline.stages.modules, limits);
  check::Suppressions(pipeline.stages.sources).apply(pipeline.result.diagnostics);
  std::ranges::move(notes, std::back_inserter(pipeline.result.diagnostics));
}

void Device::checkStackSize(VkCommandBuffer commands, std::uint32_t bytes) {
  const std::shared_ptr<LinkedPipeline> bound = boundPipeline(commands);
  if (!bound || !table.GetRayTracingShaderGroupStackSizeKHR) return;
  std::vector<check::StackFrame> chain;
  for (const std::string& stage : bound->result.chain) {
    // In several groups, the same shader can need different sizes.
    std::optional<std::uint64_t> smallest;
    for (std::size_t g = 0; g < bound->copy.groups.size(); ++g) {
      const GroupCopy& group = bound->copy.groups[g];
      const auto add = [&](const std::optional<std::size_t>& index, VkShaderGroupShaderKHR kind) {
        if (!index || bound->stages.of(*index).name != stage) return;
        const std::uint64_t size =
            table.GetRayTracingShaderGroupStackSizeKHR(handle, bound->handle, static_cast<std::uint32_t>(g), kind);
        smallest = std::min(smallest.value_or(size), size);
      };
      add(group.general, VK_SHADER_GROUP_SHADER_GENERAL_KHR);
      add(group.closestHit, VK_SHADER_GROUP_SHADER_CLOSEST_HIT_KHR);
    }
    chain.push_back({stage, smallest.value_or(0)});
  }
  if (auto found = check::checkStackSize(bytes, chain)) report({std::move(*found)}, *bound);
}

}  // namespace quintet::layer
