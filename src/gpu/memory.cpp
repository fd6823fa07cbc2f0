// SPDX-License-Identifier: Apache-2.0
#include "gpu/memory.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "gpu/error.h"
#include "gpu/mebibytes.h"
#include "gpu/vma.h"

namespace quintet::gpu {

const char* purposeName(Purpose purpose) {
  constexpr std::array<const char*, kPurposeCount> kNames{
      "geometry", "textures", "accelerationStructures", "scratch", "staging", "film", "tables"};
  return kNames[static_cast<std::size_t>(purpose)];
}

std::uint64_t DeviceMemory::unusedAtPeak() const {
  const std::uint64_t used = std::accumulate(atPeak.begin(), atPeak.end(), std::uint64_t{0});
  return peak - std::min(used, peak);
}

void MemoryAccount::addBlock(std::uint64_t size) {
  const std::lock_guard lock(mutex_);
  ++blockCount_;
  memory_.now += size;
  memory_.peak = std::max(memory_.peak, memory_.now);
}

void MemoryAccount::removeBlock(std::uint64_t size) {
  const std::lock_guard lock(mutex_);
  --blockCount_;
  memory_.now -= size;
}

void MemoryAccount::add(Purpose purpose, std::uint64_t size) {
  const std::lock_guard lock(mutex_);
  memory_.held[static_cast<std::size_t>(purpose)] += size;
  if (memory_.now == memory_.peak) memory_.atPeak = memory_.held;
}

void MemoryAccount::remove(Purpose purpose, std::uint64_t size) {
  const std::lock_guard lock(mutex_);
  memory_.held[static_cast<std::size_t>(purpose)] -= size;
}

std::size_t MemoryAccount::blockCount() const {
  const std::lock_guard lock(mutex_);
  return blockCount_;
}

DeviceMemory MemoryAccount::memory() const {
  const std::lock_guard lock(mutex_);
  return memory_;
}

Allocator::Allocator(VkInstance instance, const FoundDevice& found, VkDevice device) : software_(found.info.software) {
  VmaDeviceMemoryCallbacks callbacks{};
  callbacks.pUserData = &account_;
  callbacks.pfnAllocate = [](VmaAllocator, std::uint32_t, VkDeviceMemory, VkDeviceSize size, void* user) {
    static_cast<MemoryAccount*>(user)->addBlock(size);
  };
  callbacks.pfnFree = [](VmaAllocator, std::uint32_t, VkDeviceMemory, VkDeviceSize size, void* user) {
    static_cast<MemoryAccount*>(user)->removeBlock(size);
  };
  VmaVulkanFunctions functions{};
  functions.vkGetInstanceProcAddr = vkGetInstanceProcAddr;
  functions.vkGetDeviceProcAddr = vkGetDeviceProcAddr;
  VmaAllocatorCreateInfo info{};
  info.flags = VMA_ALLOCATOR_CREATE_BUFFER_DEVICE_ADDRESS_BIT;
  if (found.capabilities.has(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME))
    info.flags |= VMA_ALLOCATOR_CREATE_EXT_MEMORY_BUDGET_BIT;
  info.physicalDevice = found.handle;
  info.device = device;
  info.instance = instance;
  info.pVulkanFunctions = &functions;
  info.vulkanApiVersion = VK_API_VERSION_1_3;
  info.pDeviceMemoryCallbacks = &callbacks;
  info.preferredLargeHeapBlockSize = kBlockBytes;
  check(vmaCreateAllocator(&info, &handle_), "create the memory allocator");
}

Allocator::~Allocator() { vmaDestroyAllocator(handle_); }

bool Allocator::needsOwnBlock(VkDeviceSize bytes) const {
  constexpr std::size_t kManyBlocks = 1024;
  return bytes >= kOwnBlockBytes && account_.blockCount() < kManyBlocks;
}

// The user data of an allocation is its purpose.
void Allocator::track(VmaAllocation allocation, Purpose purpose) {
  VmaAllocationInfo info{};
  vmaGetAllocationInfo(handle_, allocation, &info);
  vmaSetAllocationUserData(handle_, allocation, reinterpret_cast<void*>(static_cast<std::uintptr_t>(purpose)));
  account_.add(purpose, info.size);
}

void Allocator::untrack(VmaAllocation allocation) {
  VmaAllocationInfo info{};
  vmaGetAllocationInfo(handle_, allocation, &info);
  account_.remove(static_cast<Purpose>(reinterpret_cast<std::uintptr_t>(info.pUserData)), info.size);
}

void Allocator::checkFreeMemory(VkDeviceSize bytes, const std::string& object) const {
  if (!software_) return;
  std::array<VmaBudget, VK_MAX_MEMORY_HEAPS> budgets{};
  vmaGetHeapBudgets(handle_, budgets.data());
  const VmaBudget& heap = budgets[0];  // the only heap
  // `usage` is what the whole system uses now, blockBytes what was allocated here, touched or not.
  const VkDeviceSize used = std::max(heap.usage, heap.statistics.blockBytes);
  const VkDeviceSize free = heap.budget - std::min(used, heap.budget);
  if (bytes <= free) return;
  throw MemoryError(fmt::format("cannot allocate {:.1f} MiB for {}: {:.1f} of the device's {:.1f} MiB are free",
                                mebibytes(bytes), object, mebibytes(free), mebibytes(heap.budget)));
}

}  // namespace quintet::gpu
