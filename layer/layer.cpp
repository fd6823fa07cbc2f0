// SPDX-License-Identifier: Apache-2.0
// VK_LAYER_QUINTET_link_check: links every ray tracing pipeline that an application creates (docs/layer.md). This file has the
// functions that the layer intercepts; all others go to the next layer untouched.
//
// The interface of layers is specified in the documentation of the Vulkan loader, LoaderLayerInterface.md.
#include <array>
#include <cstring>
#include <map>
#include <memory>
#include <shared_mutex>
#include <string_view>
#include <vector>

#include "device.h"
#include "instance.h"
#include "loader_interface.h"
#include "table_capture.h"

namespace quintet::layer {
namespace {

// A device, and what only the mode sbt=1 has. `tables` is destroyed first.
struct DeviceEntry {
  std::shared_ptr<Device> device;
  std::unique_ptr<TableCapture> tables;  // null without sbt=1
};

// Dispatchable handles of one instance or device point to the same table of the loader.
using Key = const void*;
template <class Handle>
Key keyOf(Handle handle) {
  return *reinterpret_cast<void* const*>(handle);
}

std::shared_mutex mutex;
std::map<Key, std::shared_ptr<Instance>> instances;
std::map<Key, std::shared_ptr<DeviceEntry>> devices;

// Runs when the process exits. Applications can exit without destroying their devices: the reports are then completed here. The
// Vulkan objects of the layer stay, because the driver can be finalized already, and so can be what messengers use. If another
// thread is creating or destroying a device at this moment, nothing is completed: waiting for it could take forever.
__attribute__((destructor)) void finishReports() {
  const std::shared_lock lock(mutex, std::try_to_lock);
  if (!lock) return;
  for (const auto& [key, instance] : instances) instance->messages.removeMessengers();
  for (const auto& [key, entry] : devices) entry->device->deliverAll();
  for (const auto& [key, instance] : instances) {
    instance->worker.waitForAll();
    instance->messages.finish();
  }
}

template <class Handle>
std::shared_ptr<Instance> instanceOf(Handle handle) {
  const std::shared_lock lock(mutex);
  return instances.at(keyOf(handle));
}

template <class Handle>
std::shared_ptr<DeviceEntry> entryOf(Handle handle) {
  const std::shared_lock lock(mutex);
  return devices.at(keyOf(handle));
}

template <class Handle>
std::shared_ptr<Device> deviceOf(Handle handle) {
  return entryOf(handle)->device;
}

// ---- Shader modules and pipelines

VKAPI_ATTR VkResult VKAPI_CALL createShaderModule(VkDevice handle, const VkShaderModuleCreateInfo* info,
                                                  const VkAllocationCallbacks* allocator, VkShaderModule* module) {
  const auto device = deviceOf(handle);
  const VkResult result = device->table.CreateShaderModule(handle, info, allocator, module);
  if (result == VK_SUCCESS) device->addModule(*module, *info);
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroyShaderModule(VkDevice handle, VkShaderModule module,
                                               const VkAllocationCallbacks* allocator) {
  const auto device = deviceOf(handle);
  device->removeModule(module);
  device->table.DestroyShaderModule(handle, module, allocator);
}

VKAPI_ATTR void VKAPI_CALL getShaderModuleIdentifier(VkDevice handle, VkShaderModule module,
                                                     VkShaderModuleIdentifierEXT* identifier) {
  const auto device = deviceOf(handle);
  device->table.GetShaderModuleIdentifierEXT(handle, module, identifier);
  device->addIdentifier(module, *identifier);
}

VKAPI_ATTR void VKAPI_CALL getShaderModuleCreateInfoIdentifier(VkDevice handle, const VkShaderModuleCreateInfo* info,
                                                               VkShaderModuleIdentifierEXT* identifier) {
  const auto device = deviceOf(handle);
  device->table.GetShaderModuleCreateInfoIdentifierEXT(handle, info, identifier);
  device->addIdentifier(*info, *identifier);
}

VKAPI_ATTR VkResult VKAPI_CALL createDescriptorSetLayout(VkDevice handle, const VkDescriptorSetLayoutCreateInfo* info,
                                                         const VkAllocationCallbacks* allocator,
                                                         VkDescriptorSetLayout* layout) {
  const auto device = deviceOf(handle);
  const VkResult result = device->table.CreateDescriptorSetLayout(handle, info, allocator, layout);
  if (result == VK_SUCCESS) device->descriptors.addSetLayout(*layout, *info);
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroyDescriptorSetLayout(VkDevice handle, VkDescriptorSetLayout layout,
                                                      const VkAllocationCallbacks* allocator) {
  const auto device = deviceOf(handle);
  device->descriptors.removeSetLayout(layout);
  device->table.DestroyDescriptorSetLayout(handle, layout, allocator);
}

VKAPI_ATTR VkResult VKAPI_CALL createPipelineLayout(VkDevice handle, const VkPipelineLayoutCreateInfo* info,
                                                    const VkAllocationCallbacks* allocator, VkPipelineLayout* layout) {
  const auto device = deviceOf(handle);
  const VkResult result = device->table.CreatePipelineLayout(handle, info, allocator, layout);
  if (result == VK_SUCCESS) device->descriptors.addPipelineLayout(*layout, *info);
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroyPipelineLayout(VkDevice handle, VkPipelineLayout layout,
                                                 const VkAllocationCallbacks* allocator) {
  const auto device = deviceOf(handle);
  device->descriptors.removePipelineLayout(layout);
  device->table.DestroyPipelineLayout(handle, layout, allocator);
}

VKAPI_ATTR VkResult VKAPI_CALL createRayTracingPipelines(VkDevice handle, VkDeferredOperationKHR operation,
                                                         VkPipelineCache cache, std::uint32_t count,
                                                         const VkRayTracingPipelineCreateInfoKHR* infos,
                                                         const VkAllocationCallbacks* allocator,
                                                         VkPipeline* pipelines) {
  const auto device = deviceOf(handle);
  std::vector<PipelineCopy> copies = device->copy(count, infos);
  // An operation can complete on a different thread before the call returns.
  if (operation != VK_NULL_HANDLE) device->defer(operation, copies, pipelines);
  const VkResult result =
      device->table.CreateRayTracingPipelinesKHR(handle, operation, cache, count, infos, allocator, pipelines);
  if (result == VK_OPERATION_DEFERRED_KHR) return result;
  if (operation != VK_NULL_HANDLE) device->cancelDeferred(operation);
  if (result >= 0) device->addPipelines(std::move(copies), pipelines);
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL getDeferredOperationResult(VkDevice handle, VkDeferredOperationKHR operation) {
  const auto device = deviceOf(handle);
  const VkResult result = device->table.GetDeferredOperationResultKHR(handle, operation);
  if (result == VK_SUCCESS) device->completeDeferred(operation);
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL deferredOperationJoin(VkDevice handle, VkDeferredOperationKHR operation) {
  const auto device = deviceOf(handle);
  const VkResult result = device->table.DeferredOperationJoinKHR(handle, operation);
  if (result == VK_SUCCESS) device->completeDeferred(operation);
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroyDeferredOperation(VkDevice handle, VkDeferredOperationKHR operation,
                                                    const VkAllocationCallbacks* allocator) {
  const auto device = deviceOf(handle);
  device->cancelDeferred(operation);
  device->table.DestroyDeferredOperationKHR(handle, operation, allocator);
}

VKAPI_ATTR void VKAPI_CALL destroyPipeline(VkDevice handle, VkPipeline pipeline,
                                           const VkAllocationCallbacks* allocator) {
  const auto entry = entryOf(handle);
  if (entry->tables) entry->tables->removePipeline(pipeline);
  entry->device->removePipeline(pipeline);
  entry->device->table.DestroyPipeline(handle, pipeline, allocator);
}

VKAPI_ATTR VkResult VKAPI_CALL setDebugUtilsObjectName(VkDevice handle, const VkDebugUtilsObjectNameInfoEXT* info) {
  const auto device = deviceOf(handle);
  device->setName(info->objectType, info->objectHandle, info->pObjectName);
  return device->table.SetDebugUtilsObjectNameEXT(handle, info);
}

VKAPI_ATTR void VKAPI_CALL cmdBindPipeline(VkCommandBuffer commands, VkPipelineBindPoint point, VkPipeline pipeline) {
  const auto device = deviceOf(commands);
  if (point == VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR) device->bind(commands, pipeline);
  device->table.CmdBindPipeline(commands, point, pipeline);
}

VKAPI_ATTR void VKAPI_CALL cmdSetStackSize(VkCommandBuffer commands, std::uint32_t bytes) {
  const auto device = deviceOf(commands);
  device->checkStackSize(commands, bytes);
  device->table.CmdSetRayTracingPipelineStackSizeKHR(commands, bytes);
}

VKAPI_ATTR VkResult VKAPI_CALL queueSubmit(VkQueue queue, std::uint32_t count, const VkSubmitInfo* submits,
                                           VkFence fence) {
  const auto entry = entryOf(queue);
  entry->device->deliverFinished();
  if (entry->tables) entry->tables->poll();
  return entry->device->table.QueueSubmit(queue, count, submits, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL queueSubmit2(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* submits,
                                            VkFence fence) {
  const auto entry = entryOf(queue);
  entry->device->deliverFinished();
  if (entry->tables) entry->tables->poll();
  return entry->device->table.QueueSubmit2(queue, count, submits, fence);
}

// ---- Only with sbt=1

VKAPI_ATTR VkResult VKAPI_CALL allocateDescriptorSets(VkDevice handle, const VkDescriptorSetAllocateInfo* info,
                                                      VkDescriptorSet* sets) {
  const auto device = deviceOf(handle);
  const VkResult result = device->table.AllocateDescriptorSets(handle, info, sets);
  if (result == VK_SUCCESS) device->descriptors.addSets(*info, sets);
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL freeDescriptorSets(VkDevice handle, VkDescriptorPool pool, std::uint32_t count,
                                                  const VkDescriptorSet* sets) {
  const auto device = deviceOf(handle);
  device->descriptors.removeSets(count, sets);
  return device->table.FreeDescriptorSets(handle, pool, count, sets);
}

VKAPI_ATTR VkResult VKAPI_CALL resetDescriptorPool(VkDevice handle, VkDescriptorPool pool,
                                                   VkDescriptorPoolResetFlags flags) {
  const auto device = deviceOf(handle);
  device->descriptors.removePool(pool);
  return device->table.ResetDescriptorPool(handle, pool, flags);
}

VKAPI_ATTR void VKAPI_CALL destroyDescriptorPool(VkDevice handle, VkDescriptorPool pool,
                                                 const VkAllocationCallbacks* allocator) {
  const auto device = deviceOf(handle);
  device->descriptors.removePool(pool);
  device->table.DestroyDescriptorPool(handle, pool, allocator);
}

VKAPI_ATTR void VKAPI_CALL cmdBindDescriptorSets(VkCommandBuffer commands, VkPipelineBindPoint point,
                                                 VkPipelineLayout layout, std::uint32_t first, std::uint32_t count,
                                                 const VkDescriptorSet* sets, std::uint32_t offsetCount,
                                                 const std::uint32_t* offsets) {
  const auto device = deviceOf(commands);
  if (point == VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR) device->descriptors.bind(commands, first, count, sets);
  device->table.CmdBindDescriptorSets(commands, point, layout, first, count, sets, offsetCount, offsets);
}

VKAPI_ATTR void VKAPI_CALL cmdBindDescriptorSets2(VkCommandBuffer commands, const BindDescriptorSetsInfo* info) {
  const auto device = deviceOf(commands);
  constexpr VkShaderStageFlags kRayTracing = VK_SHADER_STAGE_RAYGEN_BIT_KHR | VK_SHADER_STAGE_ANY_HIT_BIT_KHR |
                                             VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR | VK_SHADER_STAGE_MISS_BIT_KHR |
                                             VK_SHADER_STAGE_INTERSECTION_BIT_KHR | VK_SHADER_STAGE_CALLABLE_BIT_KHR;
  if ((info->stageFlags & kRayTracing) != 0)
    device->descriptors.bind(commands, info->firstSet, info->descriptorSetCount, info->pDescriptorSets);
  device->cmdBindDescriptorSets2(commands, info);
}

VKAPI_ATTR VkResult VKAPI_CALL queueWaitIdle(VkQueue queue) {
  const auto entry = entryOf(queue);
  const VkResult result = entry->device->table.QueueWaitIdle(queue);
  entry->tables->poll();
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL deviceWaitIdle(VkDevice handle) {
  const auto entry = entryOf(handle);
  const VkResult result = entry->device->table.DeviceWaitIdle(handle);
  entry->tables->poll();
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL waitForFences(VkDevice handle, std::uint32_t count, const VkFence* fences, VkBool32 all,
                                             std::uint64_t timeout) {
  const auto entry = entryOf(handle);
  const VkResult result = entry->device->table.WaitForFences(handle, count, fences, all, timeout);
  entry->tables->poll();
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL waitSemaphores(VkDevice handle, const VkSemaphoreWaitInfo* info, std::uint64_t timeout) {
  const auto entry = entryOf(handle);
  const VkResult result = entry->device->table.WaitSemaphores(handle, info, timeout);
  entry->tables->poll();
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL allocateCommandBuffers(VkDevice handle, const VkCommandBufferAllocateInfo* info,
                                                      VkCommandBuffer* commands) {
  const auto entry = entryOf(handle);
  const VkResult result = entry->device->table.AllocateCommandBuffers(handle, info, commands);
  if (result == VK_SUCCESS) entry->tables->addCommands(info->commandPool, info->commandBufferCount, commands);
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL beginCommandBuffer(VkCommandBuffer commands, const VkCommandBufferBeginInfo* info) {
  const auto entry = entryOf(commands);
  entry->tables->release(commands);
  entry->device->forgetCommands(commands);
  entry->device->descriptors.forget(commands);
  return entry->device->table.BeginCommandBuffer(commands, info);
}

VKAPI_ATTR void VKAPI_CALL freeCommandBuffers(VkDevice handle, VkCommandPool pool, std::uint32_t count,
                                              const VkCommandBuffer* commands) {
  const auto entry = entryOf(handle);
  for (std::uint32_t i = 0; i < count; ++i)
    if (commands[i]) entry->tables->release(commands[i]);
  entry->device->table.FreeCommandBuffers(handle, pool, count, commands);
}

VKAPI_ATTR VkResult VKAPI_CALL resetCommandPool(VkDevice handle, VkCommandPool pool, VkCommandPoolResetFlags flags) {
  const auto entry = entryOf(handle);
  entry->tables->releasePool(pool);
  return entry->device->table.ResetCommandPool(handle, pool, flags);
}

VKAPI_ATTR void VKAPI_CALL destroyCommandPool(VkDevice handle, VkCommandPool pool,
                                              const VkAllocationCallbacks* allocator) {
  const auto entry = entryOf(handle);
  entry->tables->releasePool(pool);
  entry->device->table.DestroyCommandPool(handle, pool, allocator);
}

VKAPI_ATTR VkResult VKAPI_CALL createBuffer(VkDevice handle, const VkBufferCreateInfo* info,
                                            const VkAllocationCallbacks* allocator, VkBuffer* buffer) {
  const auto entry = entryOf(handle);
  const ReadableBuffer changed(*info);
  const VkResult result = entry->device->table.CreateBuffer(handle, &changed.info(), allocator, buffer);
  if (result == VK_SUCCESS) entry->tables->addBuffer(*buffer, info->size, changed.usage());
  return result;
}

// The requirements must be those of the buffer that createBuffer() creates.
VKAPI_ATTR void VKAPI_CALL getDeviceBufferMemoryRequirements(VkDevice handle,
                                                             const VkDeviceBufferMemoryRequirements* info,
                                                             VkMemoryRequirements2* requirements) {
  const auto entry = entryOf(handle);
  const ReadableBuffer changed(*info->pCreateInfo);
  VkDeviceBufferMemoryRequirements query = *info;
  query.pCreateInfo = &changed.info();
  entry->device->table.GetDeviceBufferMemoryRequirements(handle, &query, requirements);
}

VKAPI_ATTR void VKAPI_CALL destroyBuffer(VkDevice handle, VkBuffer buffer, const VkAllocationCallbacks* allocator) {
  const auto entry = entryOf(handle);
  entry->tables->removeBuffer(buffer);
  entry->device->table.DestroyBuffer(handle, buffer, allocator);
}

VKAPI_ATTR VkDeviceAddress VKAPI_CALL getBufferDeviceAddress(VkDevice handle, const VkBufferDeviceAddressInfo* info) {
  const auto entry = entryOf(handle);
  const VkDeviceAddress address = entry->device->table.GetBufferDeviceAddress(handle, info);
  entry->tables->addAddress(info->buffer, address);
  return address;
}

std::array<VkStridedDeviceAddressRegionKHR, check::kTableKinds> regionsOf(
    const VkStridedDeviceAddressRegionKHR* generation, const VkStridedDeviceAddressRegionKHR* miss,
    const VkStridedDeviceAddressRegionKHR* hit, const VkStridedDeviceAddressRegionKHR* callable) {
  const auto region = [](const VkStridedDeviceAddressRegionKHR* given) {
    return given ? *given : VkStridedDeviceAddressRegionKHR{};
  };
  return {region(generation), region(miss), region(hit), region(callable)};
}

VKAPI_ATTR void VKAPI_CALL cmdTraceRays(VkCommandBuffer commands, const VkStridedDeviceAddressRegionKHR* generation,
                                        const VkStridedDeviceAddressRegionKHR* miss,
                                        const VkStridedDeviceAddressRegionKHR* hit,
                                        const VkStridedDeviceAddressRegionKHR* callable, std::uint32_t width,
                                        std::uint32_t height, std::uint32_t depth) {
  const auto entry = entryOf(commands);
  entry->tables->trace(commands, regionsOf(generation, miss, hit, callable));
  entry->device->table.CmdTraceRaysKHR(commands, generation, miss, hit, callable, width, height, depth);
}

VKAPI_ATTR void VKAPI_CALL cmdTraceRaysIndirect(VkCommandBuffer commands,
                                                const VkStridedDeviceAddressRegionKHR* generation,
                                                const VkStridedDeviceAddressRegionKHR* miss,
                                                const VkStridedDeviceAddressRegionKHR* hit,
                                                const VkStridedDeviceAddressRegionKHR* callable,
                                                VkDeviceAddress address) {
  const auto entry = entryOf(commands);
  entry->tables->trace(commands, regionsOf(generation, miss, hit, callable));
  entry->device->table.CmdTraceRaysIndirectKHR(commands, generation, miss, hit, callable, address);
}

VKAPI_ATTR void VKAPI_CALL cmdTraceRaysIndirect2(VkCommandBuffer commands, VkDeviceAddress address) {
  const auto entry = entryOf(commands);
  entry->tables->traceIndirect(commands, address);
  entry->device->table.CmdTraceRaysIndirect2KHR(commands, address);
}

VKAPI_ATTR VkResult VKAPI_CALL createAccelerationStructure(VkDevice handle,
                                                           const VkAccelerationStructureCreateInfoKHR* info,
                                                           const VkAllocationCallbacks* allocator,
                                                           VkAccelerationStructureKHR* structure) {
  const auto entry = entryOf(handle);
  const VkResult result = entry->device->table.CreateAccelerationStructureKHR(handle, info, allocator, structure);
  if (result == VK_SUCCESS) entry->tables->addStructure(*structure, info->type);
  return result;
}

VKAPI_ATTR void VKAPI_CALL cmdBuildAccelerationStructures(
    VkCommandBuffer commands, std::uint32_t count, const VkAccelerationStructureBuildGeometryInfoKHR* infos,
    const VkAccelerationStructureBuildRangeInfoKHR* const* ranges) {
  const auto entry = entryOf(commands);
  entry->tables->build(commands, count, infos, ranges);
  entry->device->table.CmdBuildAccelerationStructuresKHR(commands, count, infos, ranges);
}

VKAPI_ATTR void VKAPI_CALL cmdBuildAccelerationStructuresIndirect(
    VkCommandBuffer commands, std::uint32_t count, const VkAccelerationStructureBuildGeometryInfoKHR* infos,
    const VkDeviceAddress* addresses, const std::uint32_t* strides, const std::uint32_t* const* maxima) {
  const auto entry = entryOf(commands);
  entry->tables->buildIndirect(count, infos);
  entry->device->table.CmdBuildAccelerationStructuresIndirectKHR(commands, count, infos, addresses, strides, maxima);
}

VKAPI_ATTR VkResult VKAPI_CALL
buildAccelerationStructures(VkDevice handle, VkDeferredOperationKHR operation, std::uint32_t count,
                            const VkAccelerationStructureBuildGeometryInfoKHR* infos,
                            const VkAccelerationStructureBuildRangeInfoKHR* const* ranges) {
  const auto entry = entryOf(handle);
  // The inputs must stay valid until a deferred operation is complete, so they are valid now.
  entry->tables->buildOnHost(count, infos, ranges);
  return entry->device->table.BuildAccelerationStructuresKHR(handle, operation, count, infos, ranges);
}

VKAPI_ATTR VkResult VKAPI_CALL copyAccelerationStructure(VkDevice handle, VkDeferredOperationKHR operation,
                                                         const VkCopyAccelerationStructureInfoKHR* info) {
  const auto entry = entryOf(handle);
  entry->tables->copyStructure(info->src, info->dst);
  return entry->device->table.CopyAccelerationStructureKHR(handle, operation, info);
}

// What a serialized structure contains is unknown.
VKAPI_ATTR void VKAPI_CALL
cmdCopyMemoryToAccelerationStructure(VkCommandBuffer commands, const VkCopyMemoryToAccelerationStructureInfoKHR* info) {
  const auto entry = entryOf(commands);
  entry->tables->forgetStructure(info->dst);
  entry->device->table.CmdCopyMemoryToAccelerationStructureKHR(commands, info);
}

VKAPI_ATTR VkResult VKAPI_CALL copyMemoryToAccelerationStructure(
    VkDevice handle, VkDeferredOperationKHR operation, const VkCopyMemoryToAccelerationStructureInfoKHR* info) {
  const auto entry = entryOf(handle);
  entry->tables->forgetStructure(info->dst);
  return entry->device->table.CopyMemoryToAccelerationStructureKHR(handle, operation, info);
}

VKAPI_ATTR void VKAPI_CALL cmdCopyAccelerationStructure(VkCommandBuffer commands,
                                                        const VkCopyAccelerationStructureInfoKHR* info) {
  const auto entry = entryOf(commands);
  entry->tables->copyStructure(info->src, info->dst);
  entry->device->table.CmdCopyAccelerationStructureKHR(commands, info);
}

VKAPI_ATTR void VKAPI_CALL destroyAccelerationStructure(VkDevice handle, VkAccelerationStructureKHR structure,
                                                        const VkAllocationCallbacks* allocator) {
  const auto entry = entryOf(handle);
  entry->tables->removeStructure(structure);
  entry->device->table.DestroyAccelerationStructureKHR(handle, structure, allocator);
}

// ---- Instances and devices

VKAPI_ATTR VkResult VKAPI_CALL createInstance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                              VkInstance* instance) {
  auto* entry = chainEntry<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  if (!entry) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetInstanceProcAddr next = entry->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  entry->u.pLayerInfo = entry->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(next(VK_NULL_HANDLE, "vkCreateInstance"));
  const VkResult result = create(info, allocator, instance);
  if (result != VK_SUCCESS) return result;
  auto added = std::make_shared<Instance>(*instance, next);
  const std::unique_lock lock(mutex);
  instances[keyOf(*instance)] = std::move(added);
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroyInstance(VkInstance handle, const VkAllocationCallbacks* allocator) {
  if (!handle) return;
  std::shared_ptr<Instance> instance = instanceOf(handle);
  {
    const std::unique_lock lock(mutex);
    instances.erase(keyOf(handle));
  }
  const PFN_vkDestroyInstance destroy = instance->table.DestroyInstance;
  instance.reset();  // writes the counts
  destroy(handle, allocator);
}

VKAPI_ATTR VkResult VKAPI_CALL createMessenger(VkInstance handle, const VkDebugUtilsMessengerCreateInfoEXT* info,
                                               const VkAllocationCallbacks* allocator,
                                               VkDebugUtilsMessengerEXT* messenger) {
  const auto instance = instanceOf(handle);
  const VkResult result = instance->table.CreateDebugUtilsMessengerEXT(handle, info, allocator, messenger);
  if (result == VK_SUCCESS) instance->messages.addMessenger(*messenger, *info);
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroyMessenger(VkInstance handle, VkDebugUtilsMessengerEXT messenger,
                                            const VkAllocationCallbacks* allocator) {
  const auto instance = instanceOf(handle);
  instance->messages.removeMessenger(messenger);
  instance->table.DestroyDebugUtilsMessengerEXT(handle, messenger, allocator);
}

VKAPI_ATTR VkResult VKAPI_CALL createDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                            const VkAllocationCallbacks* allocator, VkDevice* device) {
  auto* entry = chainEntry<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  if (!entry) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetInstanceProcAddr nextOfInstance = entry->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  const PFN_vkGetDeviceProcAddr next = entry->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  entry->u.pLayerInfo = entry->u.pLayerInfo->pNext;
  const std::shared_ptr<Instance> instance = instanceOf(physical);
  const auto create = reinterpret_cast<PFN_vkCreateDevice>(nextOfInstance(instance->handle, "vkCreateDevice"));
  const VkResult result = create(physical, info, allocator, device);
  if (result != VK_SUCCESS) return result;
  auto added = std::make_shared<DeviceEntry>();
  added->device = std::make_shared<Device>(*device, physical, next, instance);
  if (instance->settings.sbt && added->device->table.CmdTraceRaysKHR)
    added->tables = std::make_unique<TableCapture>(*added->device);
  const std::unique_lock lock(mutex);
  devices[keyOf(*device)] = std::move(added);
  return result;
}

VKAPI_ATTR void VKAPI_CALL destroyDevice(VkDevice handle, const VkAllocationCallbacks* allocator) {
  if (!handle) return;
  std::shared_ptr<DeviceEntry> entry = entryOf(handle);
  {
    const std::unique_lock lock(mutex);
    devices.erase(keyOf(handle));
  }
  entry->tables.reset();
  entry->device->deliverAll();
  const PFN_vkDestroyDevice destroy = entry->device->table.DestroyDevice;
  entry.reset();
  destroy(handle, allocator);
}

// ---- What the layer replaces

struct Entry {
  std::string_view name;
  PFN_vkVoidFunction function;
};

PFN_vkVoidFunction find(const auto& entries, std::string_view name) {
  for (const Entry& entry : entries)
    if (name == entry.name) return entry.function;
  return nullptr;
}

PFN_vkVoidFunction deviceFunction(std::string_view name, bool sbt) {
  static const std::array kAlways{
      Entry{"vkDestroyDevice", asVoid(destroyDevice)},
      Entry{"vkCreateShaderModule", asVoid(createShaderModule)},
      Entry{"vkDestroyShaderModule", asVoid(destroyShaderModule)},
      Entry{"vkGetShaderModuleIdentifierEXT", asVoid(getShaderModuleIdentifier)},
      Entry{"vkGetShaderModuleCreateInfoIdentifierEXT", asVoid(getShaderModuleCreateInfoIdentifier)},
      Entry{"vkCreateDescriptorSetLayout", asVoid(createDescriptorSetLayout)},
      Entry{"vkDestroyDescriptorSetLayout", asVoid(destroyDescriptorSetLayout)},
      Entry{"vkCreatePipelineLayout", asVoid(createPipelineLayout)},
      Entry{"vkDestroyPipelineLayout", asVoid(destroyPipelineLayout)},
      Entry{"vkCreateRayTracingPipelinesKHR", asVoid(createRayTracingPipelines)},
      Entry{"vkGetDeferredOperationResultKHR", asVoid(getDeferredOperationResult)},
      Entry{"vkDeferredOperationJoinKHR", asVoid(deferredOperationJoin)},
      Entry{"vkDestroyDeferredOperationKHR", asVoid(destroyDeferredOperation)},
      Entry{"vkDestroyPipeline", asVoid(destroyPipeline)},
      Entry{"vkSetDebugUtilsObjectNameEXT", asVoid(setDebugUtilsObjectName)},
      Entry{"vkCmdBindPipeline", asVoid(cmdBindPipeline)},
      Entry{"vkCmdSetRayTracingPipelineStackSizeKHR", asVoid(cmdSetStackSize)},
      Entry{"vkQueueSubmit", asVoid(queueSubmit)},
      Entry{"vkQueueSubmit2", asVoid(queueSubmit2)},
      Entry{"vkQueueSubmit2KHR", asVoid(queueSubmit2)},
  };
  static const std::array kTables{
      Entry{"vkAllocateDescriptorSets", asVoid(allocateDescriptorSets)},
      Entry{"vkFreeDescriptorSets", asVoid(freeDescriptorSets)},
      Entry{"vkResetDescriptorPool", asVoid(resetDescriptorPool)},
      Entry{"vkDestroyDescriptorPool", asVoid(destroyDescriptorPool)},
      Entry{"vkCmdBindDescriptorSets", asVoid(cmdBindDescriptorSets)},
      Entry{"vkCmdBindDescriptorSets2", asVoid(cmdBindDescriptorSets2)},
      Entry{"vkCmdBindDescriptorSets2KHR", asVoid(cmdBindDescriptorSets2)},
      Entry{"vkQueueWaitIdle", asVoid(queueWaitIdle)},
      Entry{"vkDeviceWaitIdle", asVoid(deviceWaitIdle)},
      Entry{"vkWaitForFences", asVoid(waitForFences)},
      Entry{"vkWaitSemaphores", asVoid(waitSemaphores)},
      Entry{"vkWaitSemaphoresKHR", asVoid(waitSemaphores)},
      Entry{"vkAllocateCommandBuffers", asVoid(allocateCommandBuffers)},
      Entry{"vkBeginCommandBuffer", asVoid(beginCommandBuffer)},
      Entry{"vkFreeCommandBuffers", asVoid(freeCommandBuffers)},
      Entry{"vkResetCommandPool", asVoid(resetCommandPool)},
      Entry{"vkDestroyCommandPool", asVoid(destroyCommandPool)},
      Entry{"vkCreateBuffer", asVoid(createBuffer)},
      Entry{"vkDestroyBuffer", asVoid(destroyBuffer)},
      Entry{"vkGetDeviceBufferMemoryRequirements", asVoid(getDeviceBufferMemoryRequirements)},
      Entry{"vkGetDeviceBufferMemoryRequirementsKHR", asVoid(getDeviceBufferMemoryRequirements)},
      Entry{"vkGetBufferDeviceAddress", asVoid(getBufferDeviceAddress)},
      Entry{"vkGetBufferDeviceAddressKHR", asVoid(getBufferDeviceAddress)},
      Entry{"vkCmdTraceRaysKHR", asVoid(cmdTraceRays)},
      Entry{"vkCmdTraceRaysIndirectKHR", asVoid(cmdTraceRaysIndirect)},
      Entry{"vkCmdTraceRaysIndirect2KHR", asVoid(cmdTraceRaysIndirect2)},
      Entry{"vkCreateAccelerationStructureKHR", asVoid(createAccelerationStructure)},
      Entry{"vkCmdBuildAccelerationStructuresKHR", asVoid(cmdBuildAccelerationStructures)},
      Entry{"vkCmdBuildAccelerationStructuresIndirectKHR", asVoid(cmdBuildAccelerationStructuresIndirect)},
      Entry{"vkBuildAccelerationStructuresKHR", asVoid(buildAccelerationStructures)},
      Entry{"vkCmdCopyAccelerationStructureKHR", asVoid(cmdCopyAccelerationStructure)},
      Entry{"vkCopyAccelerationStructureKHR", asVoid(copyAccelerationStructure)},
      Entry{"vkCmdCopyMemoryToAccelerationStructureKHR", asVoid(cmdCopyMemoryToAccelerationStructure)},
      Entry{"vkCopyMemoryToAccelerationStructureKHR", asVoid(copyMemoryToAccelerationStructure)},
      Entry{"vkDestroyAccelerationStructureKHR", asVoid(destroyAccelerationStructure)},
  };
  if (const PFN_vkVoidFunction found = find(kAlways, name)) return found;
  return sbt ? find(kTables, name) : nullptr;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getDeviceProcAddr(VkDevice handle, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return asVoid(getDeviceProcAddr);
  const auto entry = entryOf(handle);
  const PFN_vkVoidFunction next = entry->device->next(handle, name);
  if (!next) return nullptr;  // such as the functions of an extension that is not enabled
  const PFN_vkVoidFunction replaced = deviceFunction(name, entry->tables != nullptr);
  return replaced ? replaced : next;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getInstanceProcAddr(VkInstance handle, const char* name) {
  static const std::array kAlways{
      Entry{"vkCreateInstance", asVoid(createInstance)},
      Entry{"vkDestroyInstance", asVoid(destroyInstance)},
      Entry{"vkCreateDevice", asVoid(createDevice)},
      Entry{"vkGetInstanceProcAddr", asVoid(getInstanceProcAddr)},
      Entry{"vkGetDeviceProcAddr", asVoid(getDeviceProcAddr)},
  };
  static const std::array kMessengers{
      Entry{"vkCreateDebugUtilsMessengerEXT", asVoid(createMessenger)},
      Entry{"vkDestroyDebugUtilsMessengerEXT", asVoid(destroyMessenger)},
  };
  if (const PFN_vkVoidFunction found = find(kAlways, name)) return found;
  if (!handle) return nullptr;
  const auto instance = instanceOf(handle);
  const PFN_vkVoidFunction next = instance->next(handle, name);
  if (!next) return nullptr;
  if (const PFN_vkVoidFunction found = find(kMessengers, name)) return found;
  const PFN_vkVoidFunction replaced = deviceFunction(name, instance->settings.sbt);
  return replaced ? replaced : next;
}

}  // namespace
}  // namespace quintet::layer

extern "C" __attribute__((visibility("default"))) VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* negotiation) {
  using namespace quintet::layer;
  return negotiate(*negotiation, getInstanceProcAddr, getDeviceProcAddr);
}
