// SPDX-License-Identifier: Apache-2.0
// A Vulkan device with this layer: its shader modules, its ray tracing pipelines, and what their check found. Thread-safe.
//
// A pipeline is copied when it is created: create infos are valid only during the call. The check runs on the thread of the
// instance (link_worker.h). Its diagnostics are delivered when the pipeline is bound, with a submission, or when it is
// destroyed, so that messages arrive inside of calls of the application and before the device executes the pipeline.
#ifndef QUINTET_LAYER_DEVICE_H
#define QUINTET_LAYER_DEVICE_H

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "check/check.h"
#include "check/modules/table_check.h"
#include "descriptor_layouts.h"
#include "instance.h"
#include "stage_modules.h"

namespace quintet::layer {

using Words = std::shared_ptr<const std::vector<std::uint32_t>>;

// A stage as the application passed it.
struct StageCopy {
  Words words;       // null if unknown: created from a module identifier of an earlier run, or from a pipeline binary
  std::string name;  // of VK_EXT_debug_utils; can be empty
  VkShaderStageFlagBits stage = VK_SHADER_STAGE_ALL;
  std::string entryPoint;
  shader::SpecializationValues values;
};

// A shader group; the stages are indices into PipelineCopy::stages.
struct GroupCopy {
  VkRayTracingShaderGroupTypeKHR type = VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR;
  std::optional<std::size_t> general, closestHit, anyHit, intersection;
};

struct PipelineCopy {
  std::vector<StageCopy> stages;
  std::vector<GroupCopy> groups;
  std::uint32_t depth = 0;       // maxPipelineRayRecursionDepth
  DescriptorCounts descriptors;  // of the layout, and of the layouts of libraries
  bool isLibrary = false;
  bool isComplete = true;  // false if a library is unknown, and with it some groups
};

// A pipeline, and what its check found. Immutable once `task` is done, except for what `mutex` protects.
struct LinkedPipeline {
  PipelineCopy copy;
  VkPipeline handle = VK_NULL_HANDLE;
  std::shared_ptr<LinkWorker::Task> task;  // null for a library

  // Results of the task.
  StageModules stages;
  check::PipelineGroups groups;  // the order of the tables is unknown
  check::CheckResult result;

  std::mutex mutex;
  bool delivered = false;
};

class Device {
 public:
  Device(VkDevice device, VkPhysicalDevice physical, PFN_vkGetDeviceProcAddr nextLayer,
         std::shared_ptr<Instance> owner);
  ~Device();
  Device(const Device&) = delete;

  const VkDevice handle;
  const PFN_vkGetDeviceProcAddr next;
  const std::shared_ptr<Instance> instance;
  DeviceTable table;
  check::TableLimits tableLimits;
  check::DeviceLimits limits;
  VkPhysicalDeviceMemoryProperties memory{};
  DescriptorLayouts descriptors;
  // vkCmdBindDescriptorSets2 or its KHR alias; null if there is none.
  void(VKAPI_PTR* cmdBindDescriptorSets2)(VkCommandBuffer, const BindDescriptorSetsInfo*) = nullptr;

  void addModule(VkShaderModule module, const VkShaderModuleCreateInfo& info);
  void removeModule(VkShaderModule module);
  // VK_EXT_shader_module_identifier: a later pipeline can name the SPIR-V by it.
  void addIdentifier(VkShaderModule module, const VkShaderModuleIdentifierEXT& identifier);
  void addIdentifier(const VkShaderModuleCreateInfo& info, const VkShaderModuleIdentifierEXT& identifier);
  void setName(VkObjectType type, std::uint64_t object, const char* name);
  std::string nameOf(VkObjectType type, std::uint64_t object);

  // Copies the create infos, before the next layer creates the pipelines.
  std::vector<PipelineCopy> copy(std::uint32_t count, const VkRayTracingPipelineCreateInfoKHR* infos);
  void addPipelines(std::vector<PipelineCopy> copies, const VkPipeline* pipelines);
  // The pipelines are created when the operation is complete.
  void defer(VkDeferredOperationKHR operation, std::vector<PipelineCopy> copies, const VkPipeline* pipelines);
  void completeDeferred(VkDeferredOperationKHR operation);
  void cancelDeferred(VkDeferredOperationKHR operation);
  void removePipeline(VkPipeline pipeline);

  std::shared_ptr<LinkedPipeline> pipeline(VkPipeline object);  // null if unknown
  void bind(VkCommandBuffer commands, VkPipeline pipeline);
  std::shared_ptr<LinkedPipeline> boundPipeline(VkCommandBuffer commands);
  void forgetCommands(VkCommandBuffer commands);
  void checkStackSize(VkCommandBuffer commands, std::uint32_t bytes);

  void deliver(LinkedPipeline& pipeline);  // waits for its check
  void deliverFinished();                  // does not wait
  void deliverAll();                       // waits
  void report(std::vector<Diagnostic> diagnostics, LinkedPipeline& pipeline);

 private:
  struct Deferred {
    std::vector<PipelineCopy> copies;
    const VkPipeline* pipelines = nullptr;
  };

  void link(LinkedPipeline& pipeline);

  ModuleCache cache_;
  std::mutex mutex_;
  std::unordered_map<VkShaderModule, Words> modules_;
  std::unordered_map<std::string, Words> identifiers_;
  std::unordered_map<VkPipeline, std::shared_ptr<LinkedPipeline>> pipelines_;
  std::unordered_map<VkDeferredOperationKHR, Deferred> deferred_;
  std::unordered_map<VkCommandBuffer, std::shared_ptr<LinkedPipeline>> bound_;
  std::map<std::pair<VkObjectType, std::uint64_t>, std::string> names_;
  std::atomic<bool> undelivered_ = false;
};

template <class Handle>
std::uint64_t numberOf(Handle handle) {
  return reinterpret_cast<std::uint64_t>(handle);
}

}  // namespace quintet::layer
#endif
