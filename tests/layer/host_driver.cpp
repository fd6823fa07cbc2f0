// SPDX-License-Identifier: Apache-2.0
// A Vulkan layer below the link check that stands for drivers with functions that lavapipe does not have:
//
//   vkBuildAccelerationStructuresKHR  succeeds and builds nothing, so rays must not be traced
//   VK_EXT_shader_module_identifier   identifiers are numbers, and pipelines can be created from them
//   hit objects                       stages of SPV_NV_shader_invocation_reorder do nothing, so they must not be traced
#include <cstdint>
#include <cstring>
#include <map>
#include <mutex>
#include <string_view>
#include <vector>

#include <vulkan/vulkan.h>

#include "loader_interface.h"

namespace {

using quintet::layer::asVoid;
using quintet::layer::chainEntry;
using quintet::layer::negotiate;

struct Instance {
  VkInstance handle = VK_NULL_HANDLE;
  PFN_vkGetInstanceProcAddr next = nullptr;
};

std::mutex mutex;
Instance instance;  // of the last instance; tests have one at a time
PFN_vkGetDeviceProcAddr nextOfDevice = nullptr;
PFN_vkCreateRayTracingPipelinesKHR createPipelines = nullptr;
PFN_vkCreateShaderModule createModule = nullptr;
std::map<std::uint64_t, VkShaderModule> modules;  // by identifier

VKAPI_ATTR VkResult VKAPI_CALL buildStructures(VkDevice, VkDeferredOperationKHR, std::uint32_t,
                                               const VkAccelerationStructureBuildGeometryInfoKHR*,
                                               const VkAccelerationStructureBuildRangeInfoKHR* const*) {
  return VK_SUCCESS;
}

// The execution model of a module with hit objects; 0 for any other module.
std::uint32_t modelWithHitObjects(const VkShaderModuleCreateInfo& info) {
  constexpr std::uint32_t kCapability = 17, kEntryPoint = 15, kReorder = 5383;
  constexpr std::size_t kHeader = 5;
  std::uint32_t model = 0;
  bool reorders = false;
  const std::size_t count = info.codeSize / sizeof(std::uint32_t);
  for (std::size_t at = kHeader; at + 1 < count && info.pCode[at] >> 16 != 0; at += info.pCode[at] >> 16) {
    const std::uint32_t op = info.pCode[at] & 0xFFFFu;
    if (op == kCapability && info.pCode[at + 1] == kReorder) reorders = true;
    if (op == kEntryPoint) model = info.pCode[at + 1];
  }
  return reorders ? model : 0;
}

VKAPI_ATTR VkResult VKAPI_CALL createShaderModule(VkDevice device, const VkShaderModuleCreateInfo* info,
                                                  const VkAllocationCallbacks* allocator, VkShaderModule* module) {
  const std::uint32_t model = modelWithHitObjects(*info);
  if (model == 0) return createModule(device, info, allocator, module);
  // SPIR-V 1.5 of an empty main(): %1 is void, %2 its function type, %3 main, %4 the label.
  const std::vector<std::uint32_t> empty{0x07230203,
                                         0x00010500,
                                         0,
                                         5,
                                         0,  // header
                                         2u << 16 | 17u,
                                         4479,  // OpCapability RayTracingKHR
                                         6u << 16 | 10u,
                                         0x5F565053,
                                         0x5F52484B,
                                         0x5F796172,
                                         0x63617274,
                                         0x676E69,  // OpExtension "SPV_KHR_ray_tracing"
                                         3u << 16 | 14u,
                                         0,
                                         1,  // OpMemoryModel Logical GLSL450
                                         5u << 16 | 15u,
                                         model,
                                         3,
                                         0x6E69616D,
                                         0,  // OpEntryPoint "main"
                                         2u << 16 | 19u,
                                         1,  // OpTypeVoid
                                         3u << 16 | 33u,
                                         2,
                                         1,  // OpTypeFunction
                                         5u << 16 | 54u,
                                         1,
                                         3,
                                         0,
                                         2,  // OpFunction
                                         2u << 16 | 248u,
                                         4,  // OpLabel
                                         1u << 16 | 253u,
                                         1u << 16 | 56u};  // OpReturn, OpFunctionEnd
  VkShaderModuleCreateInfo replaced = *info;
  replaced.codeSize = empty.size() * sizeof(std::uint32_t);
  replaced.pCode = empty.data();
  return createModule(device, &replaced, allocator, module);
}

VKAPI_ATTR void VKAPI_CALL getIdentifier(VkDevice, VkShaderModule module, VkShaderModuleIdentifierEXT* identifier) {
  const std::lock_guard lock(mutex);
  const std::uint64_t number = modules.size() + 1;
  modules[number] = module;
  identifier->identifierSize = sizeof number;
  std::memcpy(identifier->identifier, &number, sizeof number);
}

VKAPI_ATTR VkResult VKAPI_CALL createRayTracingPipelines(VkDevice device, VkDeferredOperationKHR operation,
                                                         VkPipelineCache cache, std::uint32_t count,
                                                         const VkRayTracingPipelineCreateInfoKHR* infos,
                                                         const VkAllocationCallbacks* allocator,
                                                         VkPipeline* pipelines) {
  const std::lock_guard lock(mutex);
  std::vector<VkRayTracingPipelineCreateInfoKHR> copies(infos, infos + count);
  std::vector<std::vector<VkPipelineShaderStageCreateInfo>> stages;
  for (VkRayTracingPipelineCreateInfoKHR& info : copies) {
    auto& list = stages.emplace_back(info.pStages, info.pStages + info.stageCount);
    for (VkPipelineShaderStageCreateInfo& stage : list) {
      const auto* given = static_cast<const VkPipelineShaderStageModuleIdentifierCreateInfoEXT*>(stage.pNext);
      if (!given || given->sType != VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_MODULE_IDENTIFIER_CREATE_INFO_EXT) continue;
      std::uint64_t number = 0;
      std::memcpy(&number, given->pIdentifier, sizeof number);
      stage.module = modules.at(number);
      stage.pNext = nullptr;
    }
    info.pStages = list.data();
    info.flags &= ~static_cast<VkPipelineCreateFlags>(VK_PIPELINE_CREATE_FAIL_ON_PIPELINE_COMPILE_REQUIRED_BIT);
  }
  return createPipelines(device, operation, cache, count, copies.data(), allocator, pipelines);
}

VKAPI_ATTR VkResult VKAPI_CALL createInstance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                              VkInstance* created) {
  auto* entry = chainEntry<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  const PFN_vkGetInstanceProcAddr next = entry->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  entry->u.pLayerInfo = entry->u.pLayerInfo->pNext;
  const VkResult result =
      reinterpret_cast<PFN_vkCreateInstance>(next(VK_NULL_HANDLE, "vkCreateInstance"))(info, allocator, created);
  instance = {*created, next};
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL createDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                            const VkAllocationCallbacks* allocator, VkDevice* device) {
  auto* entry = chainEntry<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  const PFN_vkGetDeviceProcAddr next = entry->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  entry->u.pLayerInfo = entry->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateDevice>(instance.next(instance.handle, "vkCreateDevice"));
  const VkResult result = create(physical, info, allocator, device);
  if (result != VK_SUCCESS) return result;
  nextOfDevice = next;
  createPipelines =
      reinterpret_cast<PFN_vkCreateRayTracingPipelinesKHR>(next(*device, "vkCreateRayTracingPipelinesKHR"));
  createModule = reinterpret_cast<PFN_vkCreateShaderModule>(next(*device, "vkCreateShaderModule"));
  modules.clear();
  return result;
}

PFN_vkVoidFunction deviceFunction(std::string_view name) {
  if (name == "vkBuildAccelerationStructuresKHR") return asVoid(buildStructures);
  if (name == "vkCreateShaderModule") return asVoid(createShaderModule);
  if (name == "vkGetShaderModuleIdentifierEXT") return asVoid(getIdentifier);
  if (name == "vkCreateRayTracingPipelinesKHR") return asVoid(createRayTracingPipelines);
  return nullptr;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getDeviceProcAddr(VkDevice handle, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return asVoid(getDeviceProcAddr);
  if (const PFN_vkVoidFunction own = deviceFunction(name)) return own;
  return nextOfDevice(handle, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getInstanceProcAddr(VkInstance handle, const char* name) {
  const std::string_view wanted = name;
  if (wanted == "vkCreateInstance") return asVoid(createInstance);
  if (wanted == "vkCreateDevice") return asVoid(createDevice);
  if (wanted == "vkGetInstanceProcAddr") return asVoid(getInstanceProcAddr);
  if (wanted == "vkGetDeviceProcAddr") return asVoid(getDeviceProcAddr);
  if (!handle) return nullptr;
  if (const PFN_vkVoidFunction own = deviceFunction(wanted)) return own;
  return instance.next(handle, name);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* negotiation) {
  return negotiate(*negotiation, getInstanceProcAddr, getDeviceProcAddr);
}
