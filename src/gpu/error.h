// SPDX-License-Identifier: Apache-2.0
// Exceptions for failed Vulkan calls, besides those of the public API. Messages contain the operation, the object and the VkResult.
#ifndef QUINTET_GPU_ERROR_H
#define QUINTET_GPU_ERROR_H

#include <string_view>

#include <quintet/device.h>

#include "base/error.h"
#include "gpu/vulkan.h"

namespace quintet::gpu {

// A failed call, such as "cannot create buffer 'film': VK_ERROR_TOO_MANY_OBJECTS".
class VulkanError : public Error {
 public:
  VulkanError(VkResult result, std::string_view operation, std::string_view object);
  VkResult result() const { return result_; }

 private:
  VkResult result_;
};

// No usable device. The message lists all devices with the reason why each cannot be used.
class NoDeviceError : public Error {
 public:
  using Error::Error;
};

std::string_view resultName(VkResult result);

// Throws unless result >= 0: MemoryError for exhausted memory, DeviceLostError for a lost device,
// VulkanError otherwise.
void check(VkResult result, std::string_view operation, std::string_view object = {});

}  // namespace quintet::gpu
#endif
