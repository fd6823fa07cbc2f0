// SPDX-License-Identifier: Apache-2.0
#include "gpu/present/presentation.h"

#include <cstdint>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "gpu/error.h"
#include "gpu/instance.h"

namespace quintet::gpu {
namespace {

// The first graphics queue family that can present to the surface.
std::optional<std::uint32_t> presentingFamily(VkInstance instance, VkPhysicalDevice device, VkSurfaceKHR surface) {
  const auto supports =
      instanceFunction<PFN_vkGetPhysicalDeviceSurfaceSupportKHR>(instance, "vkGetPhysicalDeviceSurfaceSupportKHR");
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!(families[i].queueFlags & VK_QUEUE_GRAPHICS_BIT)) continue;
    VkBool32 supported = VK_FALSE;
    check(supports(device, i, surface, &supported), "query the presentation support of a device");
    if (supported) return i;
  }
  return std::nullopt;
}

}  // namespace

std::string cannotPresentReason(const Capabilities& capabilities, bool presentingQueue, bool missesGlx) {
  std::vector<std::string> reasons;
  if (capabilities.apiVersion < VK_API_VERSION_1_3)
    reasons.push_back(fmt::format("Vulkan {}.{} (1.3 is required)", VK_API_VERSION_MAJOR(capabilities.apiVersion),
                                  VK_API_VERSION_MINOR(capabilities.apiVersion)));
  if (!capabilities.has(VK_KHR_SWAPCHAIN_EXTENSION_NAME)) reasons.emplace_back("no " VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  if (missesGlx)
    reasons.emplace_back("the X server has no GLX, which the driver requires");
  else if (!presentingQueue)
    reasons.emplace_back("no graphics queue that presents to this window");
  return fmt::format("{}", fmt::join(reasons, ", "));
}

std::vector<const char*> presentationExtensions(const Capabilities& capabilities) {
  std::vector<const char*> names{VK_KHR_SWAPCHAIN_EXTENSION_NAME};
  if (capabilities.has(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME)) names.push_back(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
  return names;
}

// Every device with Vulkan 1.3 has these features.
DeviceFeatures presentationFeatures() {
  DeviceFeatures features;
  features.vulkan12.bufferDeviceAddress = VK_TRUE;
  features.vulkan12.timelineSemaphore = VK_TRUE;
  features.vulkan13.synchronization2 = VK_TRUE;
  features.vulkan13.dynamicRendering = VK_TRUE;
  return features;
}

std::vector<FoundDevice> findPresentingDevices(VkInstance instance, VkSurfaceKHR surface, bool hasGlx) {
  std::vector<FoundDevice> devices = findDevices(instance);
  for (FoundDevice& device : devices) {
    const bool missesGlx = device.info.quirks.presentingRequiresGlx && !hasGlx;
    std::optional<std::uint32_t> family;
    if (!missesGlx) family = presentingFamily(instance, device.handle, surface);
    device.queueFamily = family.value_or(0);
    device.info.unusableReason = cannotPresentReason(device.capabilities, family.has_value(), missesGlx);
  }
  return devices;
}

}  // namespace quintet::gpu
