// SPDX-License-Identifier: Apache-2.0
// Device memory: the allocator, its block sizes, and the account of which purposes use the memory.
#ifndef QUINTET_GPU_MEMORY_H
#define QUINTET_GPU_MEMORY_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>

#include "gpu/device_query.h"
#include "gpu/vulkan.h"

VK_DEFINE_HANDLE(VmaAllocator)
VK_DEFINE_HANDLE(VmaAllocation)

namespace quintet::gpu {

enum class Purpose {
  geometry,  // attributes, triangles, boxes, solids
  textures,
  accelerationStructures,  // including primitive maps
  scratch,                 // of acceleration structure builds
  staging,                 // host memory for transfers
  film,
  tables,  // everything else: lights, materials, instances, shader binding tables
};
constexpr std::size_t kPurposeCount = 7;
const char* purposeName(Purpose purpose);  // "accelerationStructures"

// Device memory of a context in bytes.
struct DeviceMemory {
  std::uint64_t now = 0;
  std::uint64_t peak = 0;                           // maximum since the context was created
  std::array<std::uint64_t, kPurposeCount> held{};  // of `now`, by Purpose; the rest is free space in blocks
  // Of `peak`, by Purpose, at the last time when it was reached. The rest is free space in blocks.
  std::array<std::uint64_t, kPurposeCount> atPeak{};
  std::uint64_t unusedAtPeak() const;
};

// Thread-safe.
class MemoryAccount {
 public:
  void addBlock(std::uint64_t size);
  void removeBlock(std::uint64_t size);
  // Adds an allocation within blocks that are already counted.
  void add(Purpose purpose, std::uint64_t size);
  void remove(Purpose purpose, std::uint64_t size);
  std::size_t blockCount() const;
  DeviceMemory memory() const;

 private:
  mutable std::mutex mutex_;
  std::size_t blockCount_ = 0;
  DeviceMemory memory_;
};

// The Vulkan Memory Allocator of a device with the account of its memory.
class Allocator {
 public:
  // Size of the blocks for small buffers and images. The first blocks of each memory type have an eighth, a quarter and
  // a half of it.
  static constexpr VkDeviceSize kBlockBytes = VkDeviceSize{32} << 20;
  // Larger objects get a block of their own, which is freed with them.
  static constexpr VkDeviceSize kOwnBlockBytes = VkDeviceSize{2} << 20;

  Allocator(VkInstance instance, const FoundDevice& found, VkDevice device);
  ~Allocator();
  Allocator(const Allocator&) = delete;
  Allocator& operator=(const Allocator&) = delete;

  VmaAllocator handle() const { return handle_; }
  const MemoryAccount& account() const { return account_; }

  // Returns whether an object of this size gets a block of its own. Drivers limit the number of blocks, some to 4096,
  // so large objects share blocks once there are many.
  bool needsOwnBlock(VkDeviceSize bytes) const;

  // Adds an allocation to the account, and removes it before it is freed.
  void track(VmaAllocation allocation, Purpose purpose);
  void untrack(VmaAllocation allocation);

  // Throws MemoryError if `bytes` more exceed the memory of a software device, which is the memory of the system.
  // lavapipe allocates lazily, so the system would kill the process later. Drivers of GPUs report this error
  // themselves.
  void checkFreeMemory(VkDeviceSize bytes, const std::string& object) const;

 private:
  MemoryAccount account_;
  VmaAllocator handle_ = VK_NULL_HANDLE;
  bool software_ = false;
};

}  // namespace quintet::gpu
#endif
