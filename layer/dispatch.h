// SPDX-License-Identifier: Apache-2.0
// The functions of the next layer or the driver that this layer calls, by name. Null if it does not have them.
#ifndef QUINTET_LAYER_DISPATCH_H
#define QUINTET_LAYER_DISPATCH_H

#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

namespace quintet::layer {

#define QUINTET_INSTANCE_FUNCTIONS(X) \
  X(DestroyInstance)                  \
  X(CreateDebugUtilsMessengerEXT)     \
  X(DestroyDebugUtilsMessengerEXT)    \
  X(GetPhysicalDeviceProperties2)     \
  X(GetPhysicalDeviceMemoryProperties)

#define QUINTET_DEVICE_FUNCTIONS(X)            \
  X(DestroyDevice)                             \
  X(CreateShaderModule)                        \
  X(DestroyShaderModule)                       \
  X(CreateDescriptorSetLayout)                 \
  X(DestroyDescriptorSetLayout)                \
  X(CreatePipelineLayout)                      \
  X(DestroyPipelineLayout)                     \
  X(AllocateDescriptorSets)                    \
  X(FreeDescriptorSets)                        \
  X(ResetDescriptorPool)                       \
  X(DestroyDescriptorPool)                     \
  X(CmdBindDescriptorSets)                     \
  X(CreateRayTracingPipelinesKHR)              \
  X(DestroyPipeline)                           \
  X(GetDeferredOperationResultKHR)             \
  X(DeferredOperationJoinKHR)                  \
  X(DestroyDeferredOperationKHR)               \
  X(SetDebugUtilsObjectNameEXT)                \
  X(GetShaderModuleIdentifierEXT)              \
  X(GetShaderModuleCreateInfoIdentifierEXT)    \
  X(GetRayTracingShaderGroupHandlesKHR)        \
  X(GetRayTracingShaderGroupStackSizeKHR)      \
  X(CmdBindPipeline)                           \
  X(CmdSetRayTracingPipelineStackSizeKHR)      \
  X(QueueSubmit)                               \
  X(QueueSubmit2)                              \
  X(QueueWaitIdle)                             \
  X(DeviceWaitIdle)                            \
  X(WaitForFences)                             \
  X(WaitSemaphores)                            \
  X(AllocateCommandBuffers)                    \
  X(BeginCommandBuffer)                        \
  X(FreeCommandBuffers)                        \
  X(ResetCommandPool)                          \
  X(DestroyCommandPool)                        \
  X(CreateBuffer)                              \
  X(DestroyBuffer)                             \
  X(GetBufferDeviceAddress)                    \
  X(GetBufferMemoryRequirements)               \
  X(GetDeviceBufferMemoryRequirements)         \
  X(AllocateMemory)                            \
  X(FreeMemory)                                \
  X(BindBufferMemory)                          \
  X(MapMemory)                                 \
  X(CmdCopyBuffer)                             \
  X(CmdFillBuffer)                             \
  X(CmdPipelineBarrier)                        \
  X(CmdTraceRaysKHR)                           \
  X(CmdTraceRaysIndirectKHR)                   \
  X(CmdTraceRaysIndirect2KHR)                  \
  X(CreateAccelerationStructureKHR)            \
  X(CmdBuildAccelerationStructuresKHR)         \
  X(CmdBuildAccelerationStructuresIndirectKHR) \
  X(BuildAccelerationStructuresKHR)            \
  X(CmdCopyAccelerationStructureKHR)           \
  X(CopyAccelerationStructureKHR)              \
  X(CmdCopyMemoryToAccelerationStructureKHR)   \
  X(CopyMemoryToAccelerationStructureKHR)      \
  X(DestroyAccelerationStructureKHR)           \
  X(GetAccelerationStructureDeviceAddressKHR)

struct InstanceTable {
#define QUINTET_MEMBER(name) PFN_vk##name name = nullptr;
  QUINTET_INSTANCE_FUNCTIONS(QUINTET_MEMBER)
};

struct DeviceTable {
  QUINTET_DEVICE_FUNCTIONS(QUINTET_MEMBER)
#undef QUINTET_MEMBER
};

}  // namespace quintet::layer
#endif
