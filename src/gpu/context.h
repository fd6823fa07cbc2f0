// SPDX-License-Identifier: Apache-2.0
// The Vulkan instance, device, queue and allocator that all GPU objects use. Create one Context, pass it by reference,
// and destroy it after all objects that use it.
#ifndef QUINTET_GPU_CONTEXT_H
#define QUINTET_GPU_CONTEXT_H

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/log.h"
#include "gpu/device_info.h"
#include "gpu/memory.h"
#include "gpu/present/frame_semaphores.h"
#include "gpu/vulkan.h"

namespace quintet::gpu {

class Commands;
class PipelineStore;

// A window as the target of a device that presents, independent of the window system.
struct SurfaceSource {
  std::vector<std::string> instanceExtensions;
  std::function<VkSurfaceKHR(VkInstance)> create;  // throws Error if it fails
  bool hasGlx = true;  // false for an X server without the extension GLX (Quirks::presentingRequiresGlx)
};

struct ContextOptions {
  // Index, or part of the name, driver name or kind, case-insensitive: "1", "h200", "lavapipe", "cpu".
  // Empty means $QUINTET_DEVICE; if that is empty too, the first usable device, GPUs before CPUs.
  std::string device;
  // Enables the validation layer with synchronization validation. Its messages are counted and logged as warnings. The
  // default is true if $QUINTET_VALIDATE is set and not "0". A missing layer is an Error.
  bool validate = validationRequested();
  LogSink log;
  // Opens a device that can present to this surface instead of one with ray tracing (gpu/present/presentation.h).
  std::optional<SurfaceSource> surface = {};

  static bool validationRequested();
};

class Context {
 public:
  // Throws NoDeviceError if no device matches; the message lists all devices with the reason why each cannot be used.
  explicit Context(const ContextOptions& options = {});
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  // Returns all devices of the machine, usable or not, in the order of preference; empty without a Vulkan loader or
  // driver.
  static std::vector<DeviceInfo> devices();

  const DeviceInfo& info() const;
  const VolkDeviceTable& vk() const;
  VkInstance instance() const;
  VkPhysicalDevice physicalDevice() const;
  VkDevice device() const;
  Allocator& allocator() const;
  VkQueue queue() const;
  std::uint32_t queueFamily() const;
  VkSurfaceKHR surface() const;  // of ContextOptions::surface, else null
  const LogSink& log() const;
  DeviceMemory memory() const;  // memory that the driver has allocated
  PipelineStore& pipelines();

  // Validation messages so far, without known false alarms (isFalseAlarm).
  std::uint32_t validationMessageCount() const;
  std::vector<std::string> validationMessages() const;

  // Records and submits commands. Returns the timeline value that the device reaches at the end of this work.
  // Submissions execute in order, and each one sees the memory that earlier ones wrote.
  std::uint64_t submit(const std::function<void(Commands&)>& record, const FrameSemaphores& semaphores = {});
  std::uint64_t submitRaw(const std::function<void(VkCommandBuffer)>& record, const FrameSemaphores& semaphores = {});
  // Blocks until `value` is reached. Throws TimeoutError after timeoutSeconds; values ≤ 0 disable the limit.
  void wait(std::uint64_t value, double timeoutSeconds = 0.0);
  void submitAndWait(const std::function<void(Commands&)>& record) { wait(submit(record)); }
  std::uint64_t completed() const;  // the last timeline value that was reached
  std::uint64_t submitted() const;  // the last timeline value that submit returned

  // Calls `destroy` after all work that is submitted so far has ended, at the latest in the destructor.
  void retire(std::function<void()> destroy);

  // Names an object for validation messages and debuggers. Has no effect without the debug extension.
  void setName(VkObjectType type, std::uint64_t handle, std::string_view name);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace quintet::gpu
#endif
