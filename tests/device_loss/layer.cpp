// SPDX-License-Identifier: Apache-2.0
// A Vulkan layer that simulates the loss of a device. The first submission after a file exists returns
// VK_ERROR_DEVICE_LOST, and so do the later submissions and waits of the same device. Environment:
//
//   QUINTET_LOSE_DEVICE  "rendering": devices that enable ray tracing pipelines; "presenting": those with a swapchain
//   QUINTET_LOSE_WHEN    the file
//   QUINTET_LOSE_COUNT   number of devices of the process that are lost (1)
//   QUINTET_FAIL_DEVICE  number of a device of this kind that cannot be created: 1 is the first one of the process (none)
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string_view>

#include <vulkan/vulkan.h>

#include "loader_interface.h"

namespace {

using quintet::layer::asVoid;
using quintet::layer::chainEntry;
using quintet::layer::negotiate;

// Dispatchable handles of one instance or device point to the same table of the loader.
using Key = const void*;
template <class Handle>
Key keyOf(Handle handle) {
  return *reinterpret_cast<void* const*>(handle);
}

struct Instance {
  VkInstance handle = VK_NULL_HANDLE;
  PFN_vkGetInstanceProcAddr next = nullptr;
  PFN_vkDestroyInstance destroy = nullptr;  // of the next layer
};

struct Device {
  VkDevice handle = VK_NULL_HANDLE;
  PFN_vkGetDeviceProcAddr next = nullptr;
  bool losable = false;  // of the kind that QUINTET_LOSE_DEVICE names
  bool lost = false;
};

std::mutex mutex;
std::map<Key, Instance> instances;
std::map<Key, Device> devices;
long lossesSoFar = 0;
long creationsSoFar = 0;  // of losable devices

const char* variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

Device find(Key key) {
  const std::lock_guard lock(mutex);
  return devices.at(key);
}

template <class Function>
Function nextFunction(const Device& device, const char* name) {
  return reinterpret_cast<Function>(device.next(device.handle, name));
}

bool isLosable(const VkDeviceCreateInfo& info) {
  const std::string_view kind = variable("QUINTET_LOSE_DEVICE");
  const std::string_view extension = kind == "presenting" ? "VK_KHR_swapchain" : "VK_KHR_ray_tracing_pipeline";
  for (std::uint32_t i = 0; i < info.enabledExtensionCount; ++i)
    if (extension == info.ppEnabledExtensionNames[i]) return true;
  return false;
}

bool failsCreation(const VkDeviceCreateInfo& info) {
  if (!isLosable(info)) return false;
  const std::lock_guard lock(mutex);
  return ++creationsSoFar == std::atol(variable("QUINTET_FAIL_DEVICE"));
}

// Returns whether the device is lost at this submission or was before. A lost device executes nothing, so the work so
// far ends first.
bool loses(Key key) {
  const Device device = find(key);
  if (device.lost) return true;
  if (!device.losable || ::access(variable("QUINTET_LOSE_WHEN"), F_OK) != 0) return false;
  const char* limit = variable("QUINTET_LOSE_COUNT");
  {
    const std::lock_guard lock(mutex);
    if (lossesSoFar >= (*limit ? std::atol(limit) : 1)) return false;
    ++lossesSoFar;
    devices.at(key).lost = true;
  }
  nextFunction<PFN_vkDeviceWaitIdle>(device, "vkDeviceWaitIdle")(device.handle);
  return true;
}

// ---- Functions of devices

VKAPI_ATTR VkResult VKAPI_CALL queueSubmit(VkQueue queue, std::uint32_t count, const VkSubmitInfo* submits,
                                           VkFence fence) {
  if (loses(keyOf(queue))) return VK_ERROR_DEVICE_LOST;
  return nextFunction<PFN_vkQueueSubmit>(find(keyOf(queue)), "vkQueueSubmit")(queue, count, submits, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL queueSubmit2(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* submits,
                                            VkFence fence) {
  if (loses(keyOf(queue))) return VK_ERROR_DEVICE_LOST;
  return nextFunction<PFN_vkQueueSubmit2>(find(keyOf(queue)), "vkQueueSubmit2")(queue, count, submits, fence);
}

// Functions that only fail once the device is lost. `Name` differs for each of them.
template <class Function>
struct Guarded;
template <class Handle, class... Arguments>
struct Guarded<VkResult(VKAPI_PTR*)(Handle, Arguments...)> {
  template <const char* Name>
  static VKAPI_ATTR VkResult VKAPI_CALL call(Handle handle, Arguments... arguments) {
    const Device device = find(keyOf(handle));
    if (device.lost) return VK_ERROR_DEVICE_LOST;
    return nextFunction<VkResult(VKAPI_PTR*)(Handle, Arguments...)>(device, Name)(handle, arguments...);
  }
};

VKAPI_ATTR VkResult VKAPI_CALL deviceWaitIdle(VkDevice handle) {
  const Device device = find(keyOf(handle));
  const VkResult result = nextFunction<PFN_vkDeviceWaitIdle>(device, "vkDeviceWaitIdle")(handle);
  return device.lost ? VK_ERROR_DEVICE_LOST : result;
}

VKAPI_ATTR void VKAPI_CALL destroyDevice(VkDevice handle, const VkAllocationCallbacks* allocator) {
  if (!handle) return;
  const Device device = find(keyOf(handle));
  {
    const std::lock_guard lock(mutex);
    devices.erase(keyOf(handle));
  }
  nextFunction<PFN_vkDestroyDevice>(device, "vkDestroyDevice")(handle, allocator);
}

// ---- Functions of instances

VKAPI_ATTR VkResult VKAPI_CALL createInstance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                              VkInstance* instance) {
  auto* entry = chainEntry<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  if (!entry) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetInstanceProcAddr next = entry->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  entry->u.pLayerInfo = entry->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(next(VK_NULL_HANDLE, "vkCreateInstance"));
  const VkResult result = create(info, allocator, instance);
  if (result != VK_SUCCESS) return result;
  // Once the instance is complete, the loader would return the function of the first layer instead.
  const auto destroy = reinterpret_cast<PFN_vkDestroyInstance>(next(*instance, "vkDestroyInstance"));
  const std::lock_guard lock(mutex);
  instances[keyOf(*instance)] = {*instance, next, destroy};
  return result;
}

Instance findInstance(Key key) {
  const std::lock_guard lock(mutex);
  return instances.at(key);
}

VKAPI_ATTR void VKAPI_CALL destroyInstance(VkInstance handle, const VkAllocationCallbacks* allocator) {
  if (!handle) return;
  const Instance instance = findInstance(keyOf(handle));
  {
    const std::lock_guard lock(mutex);
    instances.erase(keyOf(handle));
  }
  instance.destroy(handle, allocator);
}

VKAPI_ATTR VkResult VKAPI_CALL createDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                            const VkAllocationCallbacks* allocator, VkDevice* device) {
  auto* entry = chainEntry<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  if (!entry) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetInstanceProcAddr nextOfInstance = entry->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  const PFN_vkGetDeviceProcAddr next = entry->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  entry->u.pLayerInfo = entry->u.pLayerInfo->pNext;
  const VkInstance instance = findInstance(keyOf(physical)).handle;
  const auto create = reinterpret_cast<PFN_vkCreateDevice>(nextOfInstance(instance, "vkCreateDevice"));
  if (failsCreation(*info)) return VK_ERROR_INITIALIZATION_FAILED;
  const VkResult result = create(physical, info, allocator, device);
  if (result != VK_SUCCESS) return result;
  const std::lock_guard lock(mutex);
  devices[keyOf(*device)] = {*device, next, isLosable(*info), false};
  return result;
}

// ---- What the layer replaces

struct Entry {
  const char* name;
  PFN_vkVoidFunction function;
};

constexpr char kWaitSemaphores[] = "vkWaitSemaphores", kGetSemaphoreCounterValue[] = "vkGetSemaphoreCounterValue",
               kWaitForFences[] = "vkWaitForFences", kGetFenceStatus[] = "vkGetFenceStatus",
               kQueueWaitIdle[] = "vkQueueWaitIdle", kQueuePresent[] = "vkQueuePresentKHR",
               kAcquireNextImage[] = "vkAcquireNextImageKHR";

PFN_vkVoidFunction deviceFunction(std::string_view name) {
  static const Entry entries[] = {
      {"vkDestroyDevice", asVoid(destroyDevice)},
      {"vkDeviceWaitIdle", asVoid(deviceWaitIdle)},
      {"vkQueueSubmit", asVoid(queueSubmit)},
      {"vkQueueSubmit2", asVoid(queueSubmit2)},
      {kWaitSemaphores, asVoid(Guarded<PFN_vkWaitSemaphores>::call<kWaitSemaphores>)},
      {kGetSemaphoreCounterValue, asVoid(Guarded<PFN_vkGetSemaphoreCounterValue>::call<kGetSemaphoreCounterValue>)},
      {kWaitForFences, asVoid(Guarded<PFN_vkWaitForFences>::call<kWaitForFences>)},
      {kGetFenceStatus, asVoid(Guarded<PFN_vkGetFenceStatus>::call<kGetFenceStatus>)},
      {kQueueWaitIdle, asVoid(Guarded<PFN_vkQueueWaitIdle>::call<kQueueWaitIdle>)},
      {kQueuePresent, asVoid(Guarded<PFN_vkQueuePresentKHR>::call<kQueuePresent>)},
      {kAcquireNextImage, asVoid(Guarded<PFN_vkAcquireNextImageKHR>::call<kAcquireNextImage>)},
  };
  for (const Entry& entry : entries)
    if (name == entry.name) return entry.function;
  return nullptr;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getDeviceProcAddr(VkDevice handle, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return asVoid(getDeviceProcAddr);
  const Device device = find(keyOf(handle));
  const PFN_vkVoidFunction next = device.next(handle, name);
  if (!next) return nullptr;  // such as the functions of an extension that is not enabled
  const PFN_vkVoidFunction replaced = deviceFunction(name);
  return replaced ? replaced : next;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getInstanceProcAddr(VkInstance instance, const char* name) {
  static const Entry entries[] = {
      {"vkCreateInstance", asVoid(createInstance)},       {"vkDestroyInstance", asVoid(destroyInstance)},
      {"vkCreateDevice", asVoid(createDevice)},           {"vkGetInstanceProcAddr", asVoid(getInstanceProcAddr)},
      {"vkGetDeviceProcAddr", asVoid(getDeviceProcAddr)},
  };
  for (const Entry& entry : entries)
    if (std::strcmp(name, entry.name) == 0) return entry.function;
  if (!instance) return nullptr;
  const PFN_vkVoidFunction next = findInstance(keyOf(instance)).next(instance, name);
  const PFN_vkVoidFunction replaced = next ? deviceFunction(name) : nullptr;
  return replaced ? replaced : next;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* negotiation) {
  return negotiate(*negotiation, getInstanceProcAddr, getDeviceProcAddr);
}
