// SPDX-License-Identifier: Apache-2.0
#include "gpu/error.h"

#include <string>

#include <fmt/format.h>

namespace quintet {

TimeoutError::TimeoutError(double seconds, const std::string& work)
    : DeviceLostError(
          fmt::format("the device did not finish {}{}within {:g} s", work, work.empty() ? "" : " ", seconds)),
      seconds_(seconds),
      work_(work) {}

namespace gpu {
namespace {

std::string describe(VkResult result, std::string_view operation, std::string_view object) {
  if (object.empty()) return fmt::format("cannot {}: {}", operation, resultName(result));
  return fmt::format("cannot {} '{}': {}", operation, object, resultName(result));
}

}  // namespace

VulkanError::VulkanError(VkResult result, std::string_view operation, std::string_view object)
    : Error(describe(result, operation, object)), result_(result) {}

std::string_view resultName(VkResult result) {
#define QUINTET_NAME(name) \
  case name: return #name
  switch (result) {
    QUINTET_NAME(VK_SUCCESS);
    QUINTET_NAME(VK_NOT_READY);
    QUINTET_NAME(VK_TIMEOUT);
    QUINTET_NAME(VK_EVENT_SET);
    QUINTET_NAME(VK_EVENT_RESET);
    QUINTET_NAME(VK_INCOMPLETE);
    QUINTET_NAME(VK_ERROR_OUT_OF_HOST_MEMORY);
    QUINTET_NAME(VK_ERROR_OUT_OF_DEVICE_MEMORY);
    QUINTET_NAME(VK_ERROR_INITIALIZATION_FAILED);
    QUINTET_NAME(VK_ERROR_DEVICE_LOST);
    QUINTET_NAME(VK_ERROR_MEMORY_MAP_FAILED);
    QUINTET_NAME(VK_ERROR_LAYER_NOT_PRESENT);
    QUINTET_NAME(VK_ERROR_EXTENSION_NOT_PRESENT);
    QUINTET_NAME(VK_ERROR_FEATURE_NOT_PRESENT);
    QUINTET_NAME(VK_ERROR_INCOMPATIBLE_DRIVER);
    QUINTET_NAME(VK_ERROR_TOO_MANY_OBJECTS);
    QUINTET_NAME(VK_ERROR_FORMAT_NOT_SUPPORTED);
    QUINTET_NAME(VK_ERROR_FRAGMENTED_POOL);
    QUINTET_NAME(VK_ERROR_UNKNOWN);
    QUINTET_NAME(VK_ERROR_OUT_OF_POOL_MEMORY);
    QUINTET_NAME(VK_ERROR_INVALID_EXTERNAL_HANDLE);
    QUINTET_NAME(VK_ERROR_FRAGMENTATION);
    QUINTET_NAME(VK_ERROR_INVALID_OPAQUE_CAPTURE_ADDRESS);
    QUINTET_NAME(VK_PIPELINE_COMPILE_REQUIRED);
    QUINTET_NAME(VK_ERROR_SURFACE_LOST_KHR);
    QUINTET_NAME(VK_SUBOPTIMAL_KHR);
    QUINTET_NAME(VK_ERROR_OUT_OF_DATE_KHR);
    QUINTET_NAME(VK_ERROR_VALIDATION_FAILED_EXT);
    QUINTET_NAME(VK_ERROR_INVALID_SHADER_NV);
    QUINTET_NAME(VK_THREAD_IDLE_KHR);
    QUINTET_NAME(VK_THREAD_DONE_KHR);
    QUINTET_NAME(VK_OPERATION_DEFERRED_KHR);
    QUINTET_NAME(VK_OPERATION_NOT_DEFERRED_KHR);
    default: return "an unknown VkResult";
  }
#undef QUINTET_NAME
}

void check(VkResult result, std::string_view operation, std::string_view object) {
  if (result >= 0) return;
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_POOL_MEMORY: throw MemoryError(describe(result, operation, object));
    case VK_ERROR_DEVICE_LOST:
      throw DeviceLostError(describe(result, operation, object) +
                            " (the driver reset the device; a shader may have hung)");
    default: throw VulkanError(result, operation, object);
  }
}

}  // namespace gpu
}  // namespace quintet
