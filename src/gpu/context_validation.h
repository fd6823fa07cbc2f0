// Where messages of the validation layers end up: counted, kept, and passed to the log.
#ifndef QUINTET_GPU_CONTEXT_VALIDATION_H
#define QUINTET_GPU_CONTEXT_VALIDATION_H

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "base/log.h"
#include "gpu/vulkan.h"

namespace quintet::gpu {

// True if the message is one that a layer gives for correct use; the reasons are in the .cpp.
bool isFalseAlarm(std::string_view messageId, std::string_view text);

// Thread-safe; must outlive the instance whose messages it receives.
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

}  // namespace quintet::gpu
#endif
