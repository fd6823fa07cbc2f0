// Memory that a driver would promise and not have.
#ifndef QUINTET_GPU_MEMORY_H
#define QUINTET_GPU_MEMORY_H

#include <string>

#include "gpu/context.h"

namespace quintet::gpu {

// Throws MemoryError if `bytes` more would exceed a software device's memory, which is the system's:
// lavapipe allocates lazily, so the system would end the process later, in the middle of the work.
// Real GPUs' drivers refuse by themselves.
void refuseOvercommitment(const Context& context, VkDeviceSize bytes, const std::string& object);

}  // namespace quintet::gpu
#endif
