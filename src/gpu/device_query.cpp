// SPDX-License-Identifier: Apache-2.0
#include "gpu/device_query.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/parallel.h"
#include "gpu/driver_environment.h"
#include "gpu/error.h"

namespace quintet::gpu {
namespace {

// Newer versions of lavapipe build trees with the shaders of Mesa's GPU drivers (PLOC). 25.0.7 does not, and 26.1.6 does; between
// them, both are assumed, because sorting in vain costs little.
constexpr std::uint32_t kLastOwnBuilder = VK_MAKE_API_VERSION(0, 25, 0, 99);
constexpr std::uint32_t kCommonBuilder = VK_MAKE_API_VERSION(0, 26, 1, 0);

constexpr const char* kRequiredExtensions[] = {
    VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME,
    VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
    VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
};
constexpr const char* kOptionalExtensions[] = {
    VK_KHR_RAY_TRACING_MAINTENANCE_1_EXTENSION_NAME,       // copies of acceleration structures, SBT access bit
    VK_KHR_PIPELINE_LIBRARY_EXTENSION_NAME,                // hit groups that are compiled separately
    VK_KHR_RAY_QUERY_EXTENSION_NAME,                       // traces without calls of shaders
    VK_EXT_MEMORY_BUDGET_EXTENSION_NAME,                   // errors instead of the system's OOM killer
    VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME,  // registers and stack sizes of a pipeline
    VK_KHR_SHADER_CLOCK_EXTENSION_NAME,                    // heat maps of the time
};

// A member of DeviceFeatures with its name for messages.
struct Feature {
  const char* name;
  VkBool32& (*member)(DeviceFeatures&);
};
#define QUINTET_FEATURE(group, field)                                     \
  Feature {                                                               \
#field, [](DeviceFeatures & f) -> VkBool32& { return f.group.field; } \
  }

const Feature kRequiredFeatures[] = {
    QUINTET_FEATURE(core.features, shaderInt64),
    QUINTET_FEATURE(vulkan12, bufferDeviceAddress),
    QUINTET_FEATURE(vulkan12, descriptorIndexing),
    QUINTET_FEATURE(vulkan12, runtimeDescriptorArray),
    QUINTET_FEATURE(vulkan12, descriptorBindingPartiallyBound),
    QUINTET_FEATURE(vulkan12, descriptorBindingVariableDescriptorCount),
    QUINTET_FEATURE(vulkan12, shaderSampledImageArrayNonUniformIndexing),
    QUINTET_FEATURE(vulkan12, scalarBlockLayout),
    QUINTET_FEATURE(vulkan12, timelineSemaphore),
    QUINTET_FEATURE(vulkan13, synchronization2),
    QUINTET_FEATURE(vulkan13, maintenance4),
    QUINTET_FEATURE(accelerationStructure, accelerationStructure),
    QUINTET_FEATURE(rayTracingPipeline, rayTracingPipeline),
};
const Feature kOptionalFeatures[] = {
    QUINTET_FEATURE(rayTracingPipeline, rayTraversalPrimitiveCulling),
    QUINTET_FEATURE(rayTracingPipeline, rayTracingPipelineTraceRaysIndirect),  // launch sizes in device memory
    QUINTET_FEATURE(rayTracingMaintenance1, rayTracingMaintenance1),
    QUINTET_FEATURE(rayQuery, rayQuery),
    QUINTET_FEATURE(pipelineExecutables, pipelineExecutableInfo),
    QUINTET_FEATURE(shaderClock, shaderSubgroupClock),
    QUINTET_FEATURE(vulkan13, dynamicRendering),  // lines over images; every device with Vulkan 1.3 has it
};
#undef QUINTET_FEATURE

bool contains(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

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

// Finds a queue family with compute (which implies transfer), preferably with graphics, because it can present.
bool findQueueFamily(VkPhysicalDevice device, std::uint32_t& family, std::uint32_t& timestampBits) {
  const std::vector<VkQueueFamilyProperties> families = queueFamilies(device);
  for (const VkQueueFlags wanted : {VK_QUEUE_COMPUTE_BIT | VK_QUEUE_GRAPHICS_BIT, int{VK_QUEUE_COMPUTE_BIT}}) {
    for (std::uint32_t i = 0; i < families.size(); ++i) {
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

std::string driverName(const VkPhysicalDeviceDriverProperties& driver) {
  if (driver.driverID == VK_DRIVER_ID_MESA_LLVMPIPE) return "lavapipe";  // llvmpipe is Mesa's OpenGL driver
  return driver.driverName;
}

std::string driverText(const VkPhysicalDeviceDriverProperties& driver) {
  std::string version = driver.driverInfo;
  if (version.starts_with("Mesa ")) version.erase(0, 5);
  return fmt::format("{} {}", driverName(driver), version);
}

Quirks lavapipeQuirks(std::uint32_t version) {
  Quirks quirks;
  quirks.keepsPrimitiveOrder = version < kCommonBuilder;
  quirks.slowInstances = true;
  quirks.slowTraceCalls = true;
  quirks.corruptsHitAttributes = true;
  quirks.noCompaction = true;
  quirks.changesNestedBuiltIns = true;
  quirks.sharesAnyHit = true;
  quirks.sharesLocalArrays = true;
  quirks.waitsInBuilds = version > kLastOwnBuilder;
  // More threads than cores balance a launch, too.
  const unsigned threads = lavapipeThreads();
  quirks.launchParts = threads > 1 && threads <= hardwareThreads() ? threads : 0;
  return quirks;
}

Quirks quirksOf(VkDriverId driver, std::uint32_t version) {
  if (driver == VK_DRIVER_ID_MESA_LLVMPIPE) return lavapipeQuirks(version);
  Quirks quirks;
  quirks.presentingRequiresGlx = driver == VK_DRIVER_ID_NVIDIA_PROPRIETARY;
  return quirks;
}

// The property structs of a device as one chain.
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
  info.driverName = driverName(properties.driver);
  for (const std::uint8_t byte : properties.vulkan11.deviceUUID) info.uuid += fmt::format("{:02x}", byte);
  info.kind = deviceKindName(core.deviceType);
  info.apiVersion = capabilities.apiVersion;
  info.memoryBytes = largestDeviceHeap(device);
  info.maxBufferBytes = std::min(properties.maintenance4.maxBufferSize, properties.vulkan11.maxMemoryAllocationSize);
  info.unusableReason = unusableReason(capabilities);
  if (info.unusableReason.empty()) info.unusableReason = wrongEnvironment(info.driver, cpuHasAvx512());
  info.limits = properties.rayTracingLimits();
  info.rayQuery = capabilities.has(VK_KHR_RAY_QUERY_EXTENSION_NAME);
  info.pipelineStatistics = capabilities.features.pipelineExecutables.pipelineExecutableInfo == VK_TRUE;
  info.shaderClock = capabilities.features.shaderClock.shaderSubgroupClock == VK_TRUE;
  info.positionFetch = capabilities.has("VK_KHR_ray_tracing_position_fetch");
  info.timestampPeriod = timestampBits ? core.limits.timestampPeriod : 0.0f;
  info.timestampBits = timestampBits;
  info.maxImageSize = core.limits.maxImageDimension2D;
  info.maxTextures = std::min({core.limits.maxPerStageDescriptorSampledImages,
                               core.limits.maxPerStageDescriptorSamplers, core.limits.maxDescriptorSetSampledImages,
                               core.limits.maxDescriptorSetSamplers, core.limits.maxPerStageResources - 1});
  info.subgroupSize = properties.vulkan11.subgroupSize;
  std::memcpy(info.pipelineCacheUuid.data(), core.pipelineCacheUUID, info.pipelineCacheUuid.size());
  info.software = properties.driver.driverID == VK_DRIVER_ID_MESA_LLVMPIPE;
  info.quirks = quirksOf(properties.driver.driverID, core.driverVersion);
  info.quirks.slowTraceCalls = info.quirks.slowTraceCalls && info.rayQuery;
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

VkPhysicalDeviceFeatures2* DeviceFeatures::chain(const std::vector<std::string>& extensions) {
  void** tail = &core.pNext;
  const auto append = [&](auto& features) {
    features.pNext = nullptr;
    *tail = &features;
    tail = &features.pNext;
  };
  append(vulkan12);
  append(vulkan13);
  if (contains(extensions, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME)) append(accelerationStructure);
  if (contains(extensions, VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME)) append(rayTracingPipeline);
  if (contains(extensions, VK_KHR_RAY_TRACING_MAINTENANCE_1_EXTENSION_NAME)) append(rayTracingMaintenance1);
  if (contains(extensions, VK_KHR_RAY_QUERY_EXTENSION_NAME)) append(rayQuery);
  if (contains(extensions, VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME)) append(pipelineExecutables);
  if (contains(extensions, VK_KHR_SHADER_CLOCK_EXTENSION_NAME)) append(shaderClock);
  return &core;
}

bool Capabilities::has(const char* extension) const { return contains(extensions, extension); }

std::string unusableReason(const Capabilities& capabilities) {
  std::vector<std::string> reasons;
  if (capabilities.apiVersion < VK_API_VERSION_1_3)
    reasons.push_back(fmt::format("Vulkan {}.{} (1.3 is required)", VK_API_VERSION_MAJOR(capabilities.apiVersion),
                                  VK_API_VERSION_MINOR(capabilities.apiVersion)));
  for (const char* extension : kRequiredExtensions)
    if (!capabilities.has(extension)) reasons.push_back(fmt::format("no {}", extension));
  // Missing features of a missing extension or of an old Vulkan version add no information.
  if (reasons.empty()) {
    DeviceFeatures features = capabilities.features;
    for (const Feature& feature : kRequiredFeatures)
      if (!feature.member(features)) reasons.push_back(fmt::format("no feature {}", feature.name));
  }
  if (!capabilities.computeQueue) reasons.push_back("no compute queue");
  return fmt::format("{}", fmt::join(reasons, ", "));
}

std::vector<const char*> extensionsToEnable(const Capabilities& capabilities) {
  std::vector<const char*> result(std::begin(kRequiredExtensions), std::end(kRequiredExtensions));
  for (const char* extension : kOptionalExtensions)
    if (capabilities.has(extension)) result.push_back(extension);
  return result;
}

DeviceFeatures featuresToEnable(const Capabilities& capabilities) {
  DeviceFeatures available = capabilities.features;
  DeviceFeatures result;
  for (const Feature& feature : kRequiredFeatures) feature.member(result) = VK_TRUE;
  for (const Feature& feature : kOptionalFeatures) feature.member(result) = feature.member(available);
  return result;
}

std::vector<VkQueueFamilyProperties> queueFamilies(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  return families;
}

std::vector<FoundDevice> findDevices(VkInstance instance) {
  std::uint32_t count = 0;
  VkResult result = vkEnumeratePhysicalDevices(instance, &count, nullptr);
  std::vector<VkPhysicalDevice> handles(count);
  if (result == VK_SUCCESS && count > 0) result = vkEnumeratePhysicalDevices(instance, &count, handles.data());
  // The loader returns this if all drivers fail to start, as on a machine without a device.
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
