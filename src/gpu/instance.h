// SPDX-License-Identifier: Apache-2.0
// The Vulkan instance: the loader, and the messages of the validation layers.
#ifndef QUINTET_GPU_INSTANCE_H
#define QUINTET_GPU_INSTANCE_H

#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/log.h"
#include "gpu/device_info.h"
#include "gpu/vulkan.h"

namespace quintet::gpu {

// Returns whether a validation layer reports this message for correct use; the list is in instance.cpp.
bool isFalseAlarm(std::string_view messageId, std::string_view text);

// Counts and keeps messages of the validation layers and passes them to the log. Thread-safe; it must outlive the
// instance.
class ValidationSink {
 public:
  explicit ValidationSink(LogSink log) : log_(std::move(log)) {}
  VkDebugUtilsMessengerCreateInfoEXT messengerInfo();
  std::uint32_t count() const;
  std::vector<std::string> messages() const;

 private:
  void receive(std::string_view id, std::string_view text, bool counts);
  static VKAPI_ATTR VkBool32 VKAPI_CALL callback(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT* data, void* self);
  LogSink log_;
  mutable std::mutex mutex_;
  std::uint32_t count_ = 0;
  std::vector<std::string> messages_;
};

// A function of an instance extension; null if the extension is not enabled.
template <class Function>
Function instanceFunction(VkInstance instance, const char* name) {
  return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance, name));
}

class Instance {
 public:
  // A null `sink` disables validation. `extensions`: names of instance extensions to enable. Throws NoDeviceError
  // without a loader or driver, and Error if the validation layer is required but missing.
  explicit Instance(ValidationSink* sink, std::span<const std::string> extensions = {});
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  VkInstance handle() const { return handle_; }
  // Null without the debug extension.
  PFN_vkSetDebugUtilsObjectNameEXT setObjectName() const { return setObjectName_; }

 private:
  void addMessenger(ValidationSink& sink);
  VkInstance handle_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  PFN_vkSetDebugUtilsObjectNameEXT setObjectName_ = nullptr;
};

}  // namespace quintet::gpu
#endif
