// How memory is taken from the driver, and what it would promise and not have.
#ifndef QUINTET_GPU_MEMORY_H
#define QUINTET_GPU_MEMORY_H

#include <string>

#include "gpu/context.h"

VK_DEFINE_HANDLE(VmaAllocation)

namespace quintet::gpu {

// Blocks from which small buffers and images are cut; the first ones of each kind of memory are an eighth, a quarter and
// a half of it. Anything of kOwnBlockBytes or more gets a block of its own, which is given back with it, unless there are
// many of them already: drivers limit their number, some to 4096.
constexpr VkDeviceSize kBlockBytes = VkDeviceSize{32} << 20;
constexpr VkDeviceSize kOwnBlockBytes = VkDeviceSize{2} << 20;
bool getsOwnBlock(Context& context, VkDeviceSize bytes);

// Books an allocation for its purpose, and takes it off the books (before it is freed).
void book(Context& context, VmaAllocation allocation, Purpose purpose);
void unbook(Context& context, VmaAllocation allocation);

// Throws MemoryError if `bytes` more would exceed a software device's memory, which is the system's:
// lavapipe allocates lazily, so the system would end the process later, in the middle of the work.
// Real GPUs' drivers refuse by themselves.
void refuseOvercommitment(const Context& context, VkDeviceSize bytes, const std::string& object);

}  // namespace quintet::gpu
#endif
