// SPDX-License-Identifier: Apache-2.0
// Chains of structures (pNext), and the structures that the headers of Vulkan 1.3.239 do not have.
#ifndef QUINTET_LAYER_CHAINS_H
#define QUINTET_LAYER_CHAINS_H

#include <cstdint>

#include <vulkan/vulkan.h>

namespace quintet::layer {

// The first structure of a type in a chain; null if there is none.
template <class Info>
const Info* findInChain(const void* chain, VkStructureType type) {
  for (auto* entry = static_cast<const VkBaseInStructure*>(chain); entry; entry = entry->pNext)
    if (entry->sType == type) return reinterpret_cast<const Info*>(entry);
  return nullptr;
}

// VkPipelineCreateFlags2CreateInfo and VkBufferUsageFlags2CreateInfo of VK_KHR_maintenance5. They replace the flags of the
// structure that they extend. Their low 32 bits mean the same.
struct Flags2 {
  VkStructureType sType;
  const void* pNext;
  std::uint64_t flags;
};
constexpr auto kPipelineFlags2 = static_cast<VkStructureType>(1000470005);
constexpr auto kBufferUsage2 = static_cast<VkStructureType>(1000470006);

}  // namespace quintet::layer
#endif
