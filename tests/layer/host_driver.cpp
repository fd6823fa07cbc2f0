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
#include <optional>
#include <string_view>
#include <vector>

#include <vulkan/vulkan.h>
#include <spirv/unified1/spirv.hpp11>

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

constexpr std::uint32_t word(spv::Op op, std::uint32_t count) { return count << 16 | static_cast<std::uint32_t>(op); }

// The execution model of a module with hit objects; nullopt for any other module.
std::optional<std::uint32_t> modelWithHitObjects(const VkShaderModuleCreateInfo& info) {
  constexpr std::size_t kHeader = 5;
  std::optional<std::uint32_t> model;
  bool reorders = false;
  const std::size_t count = info.codeSize / sizeof(std::uint32_t);
  for (std::size_t at = kHeader; at + 1 < count && info.pCode[at] >> 16 != 0; at += info.pCode[at] >> 16) {
    const auto op = static_cast<spv::Op>(info.pCode[at] & 0xFFFFu);
    const std::uint32_t operand = info.pCode[at + 1];
    if (op == spv::Op::OpCapability && operand == std::uint32_t(spv::Capability::ShaderInvocationReorderNV))
      reorders = true;
    if (op == spv::Op::OpEntryPoint) model = operand;
  }
  return reorders ? model : std::nullopt;
}

VKAPI_ATTR VkResult VKAPI_CALL createShaderModule(VkDevice device, const VkShaderModuleCreateInfo* info,
                                                  const VkAllocationCallbacks* allocator, VkShaderModule* module) {
  const auto model = modelWithHitObjects(*info);
  if (!model) return createModule(device, info, allocator, module);
  // An empty main().
  enum : std::uint32_t { kVoid = 1, kSignature, kMain, kLabel, kBound };
  // clang-format off
  const std::vector<std::uint32_t> empty{
      spv::MagicNumber, 0x00010500, 0, kBound, 0,
      word(spv::Op::OpCapability, 2), std::uint32_t(spv::Capability::RayTracingKHR),
      word(spv::Op::OpExtension, 6), 0x5F565053, 0x5F52484B, 0x5F796172, 0x63617274, 0x00676E69,  // "SPV_KHR_ray_tracing"
      word(spv::Op::OpMemoryModel, 3), std::uint32_t(spv::AddressingModel::Logical), std::uint32_t(spv::MemoryModel::GLSL450),
      word(spv::Op::OpEntryPoint, 5), *model, kMain, 0x6E69616D, 0,  // "main"
      word(spv::Op::OpTypeVoid, 2), kVoid,
      word(spv::Op::OpTypeFunction, 3), kSignature, kVoid,
      word(spv::Op::OpFunction, 5), kVoid, kMain, 0, kSignature,
      word(spv::Op::OpLabel, 2), kLabel,
      word(spv::Op::OpReturn, 1),
      word(spv::Op::OpFunctionEnd, 1)};
  // clang-format on
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
