// The Vulkan loader and an instance, with the debug messenger when validation is asked for.
#ifndef QUINTET_GPU_INSTANCE_H
#define QUINTET_GPU_INSTANCE_H

#include "gpu/vulkan.h"

namespace quintet::gpu {

class ValidationSink;

class Instance {
 public:
  // `sink` null: no validation. Throws NoDeviceError when there is no loader or no driver, and Error
  // when validation is asked for and the layer is missing.
  explicit Instance(ValidationSink* sink);
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
