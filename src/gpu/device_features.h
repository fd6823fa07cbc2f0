// Vulkan's feature structs as one chain: queried to judge a device, filled to create it.
#ifndef QUINTET_GPU_DEVICE_FEATURES_H
#define QUINTET_GPU_DEVICE_FEATURES_H

#include <string>
#include <vector>

#include "gpu/vulkan.h"

namespace quintet::gpu {

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
  VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR pipelineExecutables{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR};

  // Links the structs whose extension is in `extensions` and returns the head of the chain.
  VkPhysicalDeviceFeatures2* chain(const std::vector<std::string>& extensions);
};

// What a device offers, as far as Quintet's choice depends on it.
struct Capabilities {
  std::uint32_t apiVersion = 0;
  std::vector<std::string> extensions;
  DeviceFeatures features;  // as queried; all off below Vulkan 1.3
  bool computeQueue = false;
  bool has(const char* extension) const;
};

// Why Quintet cannot use the device: "no VK_KHR_ray_tracing_pipeline", "Vulkan 1.2 (1.3 is needed)",
// several reasons joined by ", "; empty: usable.
std::string refusalReason(const Capabilities& capabilities);

// Extensions and features to create a device with, out of those that it has: all that are needed, and
// the optional ones that other layers use if they are there.
std::vector<const char*> extensionsToEnable(const Capabilities& capabilities);
DeviceFeatures featuresToEnable(const Capabilities& capabilities);

}  // namespace quintet::gpu
#endif
