// What the machine's devices are and can do.
#ifndef QUINTET_GPU_DEVICE_QUERY_H
#define QUINTET_GPU_DEVICE_QUERY_H

#include <vector>

#include "gpu/context.h"
#include "gpu/device_features.h"

namespace quintet::gpu {

struct FoundDevice {
  VkPhysicalDevice handle = VK_NULL_HANDLE;
  DeviceInfo info;
  Capabilities capabilities;
  std::uint32_t queueFamily = 0;
};

// All devices, in the order in which Context prefers them.
std::vector<FoundDevice> findDevices(VkInstance instance);

}  // namespace quintet::gpu
#endif
