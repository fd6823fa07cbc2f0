#include "gpu/device_query.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "gpu/device_choice.h"
#include "gpu/error.h"

namespace quintet::gpu {

namespace {

std::vector<std::string> extensionNames(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr), "list a device's extensions");
  std::vector<VkExtensionProperties> properties(count);
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, properties.data()), "list a device's extensions");
  properties.resize(count);
  std::vector<std::string> names;
  for (const VkExtensionProperties& property : properties) names.emplace_back(property.extensionName);
  return names;
}

// A family with compute (which implies transfer), with graphics too if there is one: it can present.
bool findQueueFamily(VkPhysicalDevice device, std::uint32_t& family, std::uint32_t& timestampBits) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  for (const VkQueueFlags wanted : {VK_QUEUE_COMPUTE_BIT | VK_QUEUE_GRAPHICS_BIT, int{VK_QUEUE_COMPUTE_BIT}}) {
    for (std::uint32_t i = 0; i < count; ++i) {
      if ((families[i].queueFlags & wanted) != wanted) continue;
      family = i;
      timestampBits = families[i].timestampValidBits;
      return true;
    }
  }
  return false;
}

std::uint64_t largestDeviceHeap(VkPhysicalDevice device) {
  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(device, &memory);
  std::uint64_t largest = 0;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
      largest = std::max<std::uint64_t>(largest, memory.memoryHeaps[i].size);
  return largest;
}

std::string driverText(const VkPhysicalDeviceDriverProperties& driver) {
  std::string name = driver.driverName;
  std::string version = driver.driverInfo;
  if (driver.driverID == VK_DRIVER_ID_MESA_LLVMPIPE) name = "lavapipe";  // the Vulkan driver's own name
  if (version.starts_with("Mesa ")) version.erase(0, 5);
  return fmt::format("{} {}", name, version);
}

Quirks quirksOf(VkDriverId driver) {
  Quirks quirks;
  if (driver != VK_DRIVER_ID_MESA_LLVMPIPE) return quirks;
  quirks.software = true;
  quirks.keepsPrimitiveOrder = true;
  quirks.corruptsHitAttributes = true;
  quirks.noCompaction = true;
  quirks.changesNestedBuiltIns = true;
  quirks.sharesAnyHit = true;
  quirks.sharesLocalArrays = true;
  return quirks;
}

// The property structs that describe a device, as one chain.
struct DeviceProperties {
  VkPhysicalDeviceProperties2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  VkPhysicalDeviceVulkan11Properties vulkan11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
  VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceMaintenance4Properties maintenance4{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES};
  VkPhysicalDeviceRayTracingPipelinePropertiesKHR rayTracing{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR};
  VkPhysicalDeviceAccelerationStructurePropertiesKHR accelerationStructure{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR};

  DeviceProperties(VkPhysicalDevice device, const Capabilities& capabilities) {
    void** tail = &core.pNext;
    const auto append = [&](auto& properties) { *tail = &properties, tail = &properties.pNext; };
    if (capabilities.apiVersion >= VK_API_VERSION_1_2) append(vulkan11), append(driver);
    if (capabilities.apiVersion >= VK_API_VERSION_1_3) append(maintenance4);
    if (capabilities.has(VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME)) append(rayTracing);
    if (capabilities.has(VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME)) append(accelerationStructure);
    vkGetPhysicalDeviceProperties2(device, &core);
  }
  DeviceProperties(const DeviceProperties&) = delete;
  DeviceProperties& operator=(const DeviceProperties&) = delete;

  RayTracingLimits rayTracingLimits() const {
    RayTracingLimits limits;
    limits.handleSize = rayTracing.shaderGroupHandleSize;
    limits.handleAlignment = rayTracing.shaderGroupHandleAlignment;
    limits.baseAlignment = rayTracing.shaderGroupBaseAlignment;
    limits.maxRecordStride = rayTracing.maxShaderGroupStride;
    limits.maxRecursionDepth = rayTracing.maxRayRecursionDepth;
    limits.maxHitAttributeSize = rayTracing.maxRayHitAttributeSize;
    limits.maxLaunchInvocations = rayTracing.maxRayDispatchInvocationCount;
    limits.scratchAlignment = accelerationStructure.minAccelerationStructureScratchOffsetAlignment;
    limits.maxGeometries = accelerationStructure.maxGeometryCount;
    limits.maxInstances = accelerationStructure.maxInstanceCount;
    limits.maxPrimitives = accelerationStructure.maxPrimitiveCount;
    return limits;
  }
};

DeviceInfo describe(VkPhysicalDevice device, const Capabilities& capabilities, std::uint32_t timestampBits) {
  const DeviceProperties properties(device, capabilities);
  const VkPhysicalDeviceProperties& core = properties.core.properties;
  DeviceInfo info;
  info.name = core.deviceName;
  info.driver = driverText(properties.driver);
  for (const std::uint8_t byte : properties.vulkan11.deviceUUID) info.uuid += fmt::format("{:02x}", byte);
  info.kind = deviceKindName(core.deviceType);
  info.apiVersion = capabilities.apiVersion;
  info.memoryBytes = largestDeviceHeap(device);
  info.maxBufferBytes = std::min(properties.maintenance4.maxBufferSize, properties.vulkan11.maxMemoryAllocationSize);
  info.refusal = refusalReason(capabilities);
  info.limits = properties.rayTracingLimits();
  info.rayQuery = capabilities.has(VK_KHR_RAY_QUERY_EXTENSION_NAME);
  info.pipelineStatistics = capabilities.features.pipelineExecutables.pipelineExecutableInfo == VK_TRUE;
  info.positionFetch = capabilities.has("VK_KHR_ray_tracing_position_fetch");
  info.timestampPeriod = timestampBits ? core.limits.timestampPeriod : 0.0f;
  info.timestampBits = timestampBits;
  info.maxImageSize = core.limits.maxImageDimension2D;
  info.maxTextures = std::min({core.limits.maxPerStageDescriptorSampledImages,
                               core.limits.maxPerStageDescriptorSamplers, core.limits.maxDescriptorSetSampledImages,
                               core.limits.maxDescriptorSetSamplers, core.limits.maxPerStageResources - 1});
  info.subgroupSize = properties.vulkan11.subgroupSize;
  std::memcpy(info.pipelineCacheUuid.data(), core.pipelineCacheUUID, info.pipelineCacheUuid.size());
  info.quirks = quirksOf(properties.driver.driverID);
  return info;
}

FoundDevice inspect(VkPhysicalDevice device) {
  FoundDevice found;
  found.handle = device;
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(device, &properties);
  Capabilities& capabilities = found.capabilities;
  capabilities.apiVersion = properties.apiVersion;
  capabilities.extensions = extensionNames(device);
  if (properties.apiVersion >= VK_API_VERSION_1_3)
    vkGetPhysicalDeviceFeatures2(device, capabilities.features.chain(capabilities.extensions));
  std::uint32_t timestampBits = 0;
  capabilities.computeQueue = findQueueFamily(device, found.queueFamily, timestampBits);
  found.info = describe(device, capabilities, timestampBits);
  return found;
}

}  // namespace

std::vector<FoundDevice> findDevices(VkInstance instance) {
  std::uint32_t count = 0;
  VkResult result = vkEnumeratePhysicalDevices(instance, &count, nullptr);
  std::vector<VkPhysicalDevice> handles(count);
  if (result == VK_SUCCESS && count > 0) result = vkEnumeratePhysicalDevices(instance, &count, handles.data());
  // The loader's answer when all drivers refuse to start, as on a machine without any device.
  if (result == VK_ERROR_INITIALIZATION_FAILED) return {};
  check(result, "list the Vulkan devices");
  handles.resize(count);

  std::vector<FoundDevice> devices;
  for (VkPhysicalDevice handle : handles) devices.push_back(inspect(handle));
  std::stable_sort(devices.begin(), devices.end(), [](const FoundDevice& a, const FoundDevice& b) {
    return devicePreference(a.info.kind) < devicePreference(b.info.kind);
  });
  for (std::uint32_t i = 0; i < devices.size(); ++i) devices[i].info.index = i;
  return devices;
}

}  // namespace quintet::gpu
