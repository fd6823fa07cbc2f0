// Failures of Vulkan, with the operation, the object's name and the VkResult's name.
#ifndef QUINTET_GPU_ERROR_H
#define QUINTET_GPU_ERROR_H

#include <string_view>

#include "base/error.h"
#include "gpu/vulkan.h"

namespace quintet::gpu {

// "cannot create buffer 'film': VK_ERROR_OUT_OF_DEVICE_MEMORY"
class VulkanError : public Error {
 public:
  VulkanError(VkResult result, std::string_view operation, std::string_view object);
  VkResult result() const { return result_; }

 private:
  VkResult result_;
};

// No device fits; the message lists each device found with the reason for its refusal.
class NoDeviceError : public Error {
 public:
  using Error::Error;
};

// The device was lost or did not finish in time (a shader that hangs).
class DeviceLostError : public Error {
 public:
  using Error::Error;
};

// It did not finish in time, and still works on it: what it uses must not be destroyed.
class TimeoutError : public DeviceLostError {
 public:
  explicit TimeoutError(double seconds);
  double seconds() const { return seconds_; }

 private:
  double seconds_;
};

std::string_view resultName(VkResult result);

// Throws unless result >= 0: MemoryError for exhausted memory, DeviceLostError for a lost device,
// VulkanError otherwise.
void check(VkResult result, std::string_view operation, std::string_view object = {});

}  // namespace quintet::gpu
#endif
