#include "gpu/memory.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "gpu/error.h"
#include "gpu/vma.h"

namespace quintet::gpu {

bool getsOwnBlock(Context& context, VkDeviceSize bytes) {
  constexpr std::size_t kManyBlocks = 1024;
  return bytes >= kOwnBlockBytes && context.memoryAccount().blockCount() < kManyBlocks;
}

// The allocation itself remembers what it is for.
void book(Context& context, VmaAllocation allocation, Purpose purpose) {
  VmaAllocationInfo info{};
  vmaGetAllocationInfo(context.allocator(), allocation, &info);
  vmaSetAllocationUserData(context.allocator(), allocation,
                           reinterpret_cast<void*>(static_cast<std::uintptr_t>(purpose)));
  context.memoryAccount().add(purpose, info.size);
}

void unbook(Context& context, VmaAllocation allocation) {
  VmaAllocationInfo info{};
  vmaGetAllocationInfo(context.allocator(), allocation, &info);
  context.memoryAccount().remove(static_cast<Purpose>(reinterpret_cast<std::uintptr_t>(info.pUserData)), info.size);
}

void refuseOvercommitment(const Context& context, VkDeviceSize bytes, const std::string& object) {
  if (!context.info().quirks.software) return;
  std::array<VmaBudget, VK_MAX_MEMORY_HEAPS> budgets{};
  vmaGetHeapBudgets(context.allocator(), budgets.data());
  const VmaBudget& heap = budgets[0];  // its only one
  // `usage` is what the whole system uses now; blockBytes what we were promised, touched or not.
  const VkDeviceSize used = std::max(heap.usage, heap.statistics.blockBytes);
  const VkDeviceSize free = heap.budget - std::min(used, heap.budget);
  if (bytes <= free) return;
  constexpr double kMiB = 1024.0 * 1024.0;
  throw MemoryError(fmt::format("cannot allocate {:.1f} MiB for {}: {:.1f} of the device's {:.1f} MiB are free",
                                static_cast<double>(bytes) / kMiB, object, static_cast<double>(free) / kMiB,
                                static_cast<double>(heap.budget) / kMiB));
}

}  // namespace quintet::gpu
