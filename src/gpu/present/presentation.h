// SPDX-License-Identifier: Apache-2.0
// Which devices can present to a surface, and what is enabled on them. Presenting requires no ray tracing, so an image
// that one device renders can be shown by a different one.
#ifndef QUINTET_GPU_PRESENT_PRESENTATION_H
#define QUINTET_GPU_PRESENT_PRESENTATION_H

#include <string>
#include <vector>

#include "gpu/device_query.h"
#include "gpu/vulkan.h"

namespace quintet::gpu {

// Returns why the device cannot present: "no VK_KHR_swapchain", "Vulkan 1.2 (1.3 is required)", or several reasons
// joined by ", "; empty if it can. `presentingQueue`: it has a graphics queue that can present to the surface.
// `missesGlx`: the surface is one of an X server without GLX, and the driver requires it.
std::string cannotPresentReason(const Capabilities& capabilities, bool presentingQueue, bool missesGlx = false);

// Return the extensions and features to enable: all required ones, and the supported optional ones.
std::vector<const char*> presentationExtensions(const Capabilities& capabilities);
DeviceFeatures presentationFeatures();

// All devices in the order of preference. FoundDevice::queueFamily and DeviceInfo::unusableReason are those for
// presenting to this surface. `hasGlx`: SurfaceSource::hasGlx.
std::vector<FoundDevice> findPresentingDevices(VkInstance instance, VkSurfaceKHR surface, bool hasGlx);

}  // namespace quintet::gpu
#endif
