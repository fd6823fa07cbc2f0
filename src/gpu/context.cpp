// SPDX-License-Identifier: Apache-2.0
#include "gpu/context.h"

#include <cstdlib>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/parallel.h"
#include "gpu/device_list.h"
#include "gpu/device_query.h"
#include "gpu/driver_environment.h"
#include "gpu/error.h"
#include "gpu/instance.h"
#include "gpu/pipeline_store.h"
#include "gpu/present/presentation.h"
#include "gpu/submissions.h"

namespace quintet::gpu {
namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

// The surface of a window, or none.
struct Surface {
  Surface(VkInstance owner, const std::optional<SurfaceSource>& source)
      : instance(owner), handle(source ? source->create(owner) : VK_NULL_HANDLE) {}
  ~Surface() {
    if (handle) instanceFunction<PFN_vkDestroySurfaceKHR>(instance, "vkDestroySurfaceKHR")(instance, handle, nullptr);
  }
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;

  VkInstance instance;
  VkSurfaceKHR handle;
};

// `surface`: null selects among the devices with ray tracing.
FoundDevice findDevice(VkInstance instance, VkSurfaceKHR surface, const ContextOptions& options) {
  std::vector<FoundDevice> devices =
      surface ? findPresentingDevices(instance, surface, options.surface->hasGlx) : findDevices(instance);
  std::vector<DeviceInfo> infos;
  for (const FoundDevice& device : devices) infos.push_back(device.info);
  return devices[chooseOneDevice(infos, options.device, environment("QUINTET_DEVICE"))];
}

// The logical device with one queue.
struct Device {
  Device(FoundDevice& found, bool presents) {
    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queueInfo{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queueInfo.queueFamilyIndex = found.queueFamily;
    queueInfo.queueCount = 1;
    queueInfo.pQueuePriorities = &priority;

    const std::vector<const char*> extensions =
        presents ? presentationExtensions(found.capabilities) : extensionsToEnable(found.capabilities);
    DeviceFeatures features = presents ? presentationFeatures() : featuresToEnable(found.capabilities);
    VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    info.pNext = features.chain({extensions.begin(), extensions.end()});
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queueInfo;
    info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    check(vkCreateDevice(found.handle, &info, nullptr, &handle), "create the device", found.info.name);
    volkLoadDeviceTable(&vk, handle);
    vk.vkGetDeviceQueue(handle, found.queueFamily, 0, &queue);
  }
  ~Device() { vk.vkDestroyDevice(handle, nullptr); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkDevice handle = VK_NULL_HANDLE;
  VolkDeviceTable vk{};
  VkQueue queue = VK_NULL_HANDLE;
};

}  // namespace

// Not destroyed if the device hangs (see ~Context), otherwise from the last member to the first.
struct Context::Impl {
  explicit Impl(const ContextOptions& options)
      : log(options.log),
        sink(options.log),
        instance(options.validate ? &sink : nullptr, instanceExtensions(options)),
        surface(instance.handle(), options.surface),
        found(findDevice(instance.handle(), surface.handle, options)),
        device(found, options.surface.has_value()),
        allocator(instance.handle(), found, device.handle),
        submissions(device.vk, device.handle, device.queue, found.queueFamily),
        pipelines(device.vk, device.handle, [this](auto destroy) { submissions.retire(std::move(destroy)); }) {}

  static std::span<const std::string> instanceExtensions(const ContextOptions& options) {
    return options.surface ? std::span<const std::string>(options.surface->instanceExtensions)
                           : std::span<const std::string>();
  }

  LogSink log;
  ValidationSink sink;
  Instance instance;
  Surface surface;
  FoundDevice found;
  Device device;
  Allocator allocator;
  Submissions submissions;
  PipelineStore pipelines;
};

bool ContextOptions::validationRequested() {
  const std::string value = environment("QUINTET_VALIDATE");
  return !value.empty() && value != "0";
}

Context::Context(const ContextOptions& options) : impl_(std::make_unique<Impl>(options)) {
  if (options.log && info().quirks.waitsInBuilds && lavapipeThreads() > hardwareThreads())
    options.log(LogLevel::warning,
                fmt::format("{}: builds of acceleration structures take long with {} threads; set LP_NUM_THREADS={}",
                            info().name, lavapipeThreads(), hardwareThreads()));
}

Context::~Context() {
  // A hung device still uses its objects, and destroying it would wait forever, so the objects are leaked.
  if (!impl_->submissions.shutDown()) static_cast<void>(impl_.release());
}

std::vector<DeviceInfo> Context::devices() {
  std::vector<DeviceInfo> result;
  try {
    const Instance instance(nullptr);
    for (FoundDevice& device : findDevices(instance.handle())) result.push_back(std::move(device.info));
  } catch (const NoDeviceError&) {
    result.clear();
  }
  return result;
}

const DeviceInfo& Context::info() const { return impl_->found.info; }
const VolkDeviceTable& Context::vk() const { return impl_->device.vk; }
VkInstance Context::instance() const { return impl_->instance.handle(); }
VkPhysicalDevice Context::physicalDevice() const { return impl_->found.handle; }
VkDevice Context::device() const { return impl_->device.handle; }
Allocator& Context::allocator() const { return impl_->allocator; }
VkQueue Context::queue() const { return impl_->device.queue; }
std::uint32_t Context::queueFamily() const { return impl_->found.queueFamily; }
VkSurfaceKHR Context::surface() const { return impl_->surface.handle; }
const LogSink& Context::log() const { return impl_->log; }
DeviceMemory Context::memory() const { return impl_->allocator.account().memory(); }
PipelineStore& Context::pipelines() { return impl_->pipelines; }

std::uint32_t Context::validationMessageCount() const { return impl_->sink.count(); }
std::vector<std::string> Context::validationMessages() const { return impl_->sink.messages(); }

std::uint64_t Context::submitRaw(const std::function<void(VkCommandBuffer)>& record,
                                 const FrameSemaphores& semaphores) {
  return impl_->submissions.submit(record, semaphores);
}
void Context::wait(std::uint64_t value, double timeoutSeconds) { impl_->submissions.wait(value, timeoutSeconds); }
std::uint64_t Context::completed() const { return impl_->submissions.completed(); }
std::uint64_t Context::submitted() const { return impl_->submissions.submitted(); }
void Context::retire(std::function<void()> destroy) { impl_->submissions.retire(std::move(destroy)); }

void Context::setName(VkObjectType type, std::uint64_t handle, std::string_view name) {
  const PFN_vkSetDebugUtilsObjectNameEXT set = impl_->instance.setObjectName();
  if (!set || name.empty()) return;
  const std::string text(name);
  VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
  info.objectType = type;
  info.objectHandle = handle;
  info.pObjectName = text.c_str();
  check(set(impl_->device.handle, &info), "name an object", text);
}

}  // namespace quintet::gpu
