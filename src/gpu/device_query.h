// SPDX-License-Identifier: Apache-2.0
// Queries the devices of the machine and selects the extensions and features to enable.
#ifndef QUINTET_GPU_DEVICE_QUERY_H
#define QUINTET_GPU_DEVICE_QUERY_H

#include <cstdint>
#include <string>
#include <vector>

#include "gpu/device_info.h"
#include "gpu/vulkan.h"

namespace quintet::gpu {

// The feature structs as one chain, for queries and for device creation.
struct DeviceFeatures {
  VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  VkPhysicalDeviceVulkan12Features vulkan12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceVulkan13Features vulkan13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceAccelerationStructureFeaturesKHR accelerationStructure{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR};
  VkPhysicalDeviceRayTracingPipelineFeaturesKHR rayTracingPipeline{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR};
  VkPhysicalDeviceRayTracingMaintenance1FeaturesKHR rayTracingMaintenance1{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_MAINTENANCE_1_FEATURES_KHR};
  VkPhysicalDeviceRayQueryFeaturesKHR rayQuery{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR};
  VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR pipelineExecutables{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR};
  VkPhysicalDeviceShaderClockFeaturesKHR shaderClock{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_CLOCK_FEATURES_KHR};

  // Links the structs whose extension is in `extensions` and returns the head of the chain.
  VkPhysicalDeviceFeatures2* chain(const std::vector<std::string>& extensions);
};

// Properties of a device that decide whether Quintet can use it.
struct Capabilities {
  std::uint32_t apiVersion = 0;
  std::vector<std::string> extensions;
  DeviceFeatures features;  // as queried; all disabled below Vulkan 1.3
  bool computeQueue = false;
  bool has(const char* extension) const;
};

// Returns why Quintet cannot use the device: "no VK_KHR_ray_tracing_pipeline", "Vulkan 1.2 (1.3 is required)", or
// several reasons joined by ", "; empty if it can.
std::string unusableReason(const Capabilities& capabilities);

// Return the extensions and features to enable: all required ones, and the supported optional ones.
std::vector<const char*> extensionsToEnable(const Capabilities& capabilities);
DeviceFeatures featuresToEnable(const Capabilities& capabilities);

struct FoundDevice {
  VkPhysicalDevice handle = VK_NULL_HANDLE;
  DeviceInfo info;
  Capabilities capabilities;
  std::uint32_t queueFamily = 0;
};

std::vector<VkQueueFamilyProperties> queueFamilies(VkPhysicalDevice device);

// Returns all devices in the order of preference.
std::vector<FoundDevice> findDevices(VkInstance instance);

}  // namespace quintet::gpu
#endif
