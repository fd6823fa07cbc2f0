#include "gpu/device_features.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace quintet::gpu {

namespace {

constexpr const char* kNeededExtensions[] = {
    VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME,
    VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
    VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
};
constexpr const char* kOptionalExtensions[] = {
    VK_KHR_RAY_TRACING_MAINTENANCE_1_EXTENSION_NAME,       // copies of acceleration structures, SBT access bit
    VK_KHR_PIPELINE_LIBRARY_EXTENSION_NAME,                // hit groups compiled on their own
    VK_EXT_MEMORY_BUDGET_EXTENSION_NAME,                   // exhausted memory is an error, not the system's OOM killer
    VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME,  // registers, stack: what the driver tells of a pipeline
};

// One feature: its member of DeviceFeatures and its name in a refusal.
struct Feature {
  const char* name;
  VkBool32& (*member)(DeviceFeatures&);
};
#define QUINTET_FEATURE(group, field)                                     \
  Feature {                                                               \
#field, [](DeviceFeatures & f) -> VkBool32& { return f.group.field; } \
  }

const Feature kNeededFeatures[] = {
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
    QUINTET_FEATURE(rayTracingPipeline, rayTracingPipelineTraceRaysIndirect),  // launch sizes from memory
    QUINTET_FEATURE(rayTracingMaintenance1, rayTracingMaintenance1),
    QUINTET_FEATURE(pipelineExecutables, pipelineExecutableInfo),
};
#undef QUINTET_FEATURE

bool contains(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
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
  if (contains(extensions, VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME)) append(pipelineExecutables);
  return &core;
}

bool Capabilities::has(const char* extension) const { return contains(extensions, extension); }

std::string refusalReason(const Capabilities& capabilities) {
  std::vector<std::string> reasons;
  if (capabilities.apiVersion < VK_API_VERSION_1_3)
    reasons.push_back(fmt::format("Vulkan {}.{} (1.3 is needed)", VK_API_VERSION_MAJOR(capabilities.apiVersion),
                                  VK_API_VERSION_MINOR(capabilities.apiVersion)));
  for (const char* extension : kNeededExtensions)
    if (!capabilities.has(extension)) reasons.push_back(fmt::format("no {}", extension));
  // Features of an extension that is missing, or of a Vulkan that is too old, say nothing new.
  if (reasons.empty()) {
    DeviceFeatures features = capabilities.features;
    for (const Feature& feature : kNeededFeatures)
      if (!feature.member(features)) reasons.push_back(fmt::format("no feature {}", feature.name));
  }
  if (!capabilities.computeQueue) reasons.push_back("no compute queue");
  return fmt::format("{}", fmt::join(reasons, ", "));
}

std::vector<const char*> extensionsToEnable(const Capabilities& capabilities) {
  std::vector<const char*> result(std::begin(kNeededExtensions), std::end(kNeededExtensions));
  for (const char* extension : kOptionalExtensions)
    if (capabilities.has(extension)) result.push_back(extension);
  return result;
}

DeviceFeatures featuresToEnable(const Capabilities& capabilities) {
  DeviceFeatures available = capabilities.features;
  DeviceFeatures result;
  for (const Feature& feature : kNeededFeatures) feature.member(result) = VK_TRUE;
  for (const Feature& feature : kOptionalFeatures) feature.member(result) = feature.member(available);
  return result;
}

}  // namespace quintet::gpu
