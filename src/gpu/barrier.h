// SPDX-License-Identifier: Apache-2.0
// Global memory barriers between pipeline stages (synchronization2).
#ifndef QUINTET_GPU_BARRIER_H
#define QUINTET_GPU_BARRIER_H

#include "gpu/vulkan.h"

namespace quintet::gpu {

// A pipeline stage together with its relevant memory accesses.
enum class Stage { host, transfer, compute, rayTracing, accelerationStructureBuild, all };

// Makes all memory that `before` wrote visible to `after`.
void recordBarrier(const VolkDeviceTable& vk, VkCommandBuffer commands, Stage before, Stage after);

}  // namespace quintet::gpu
#endif
