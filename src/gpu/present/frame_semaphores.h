// SPDX-License-Identifier: Apache-2.0
// How a submission is ordered with the images of a swapchain.
#ifndef QUINTET_GPU_PRESENT_FRAME_SEMAPHORES_H
#define QUINTET_GPU_PRESENT_FRAME_SEMAPHORES_H

#include "gpu/vulkan.h"

namespace quintet::gpu {

// Binary semaphores of a submission; null means none.
struct FrameSemaphores {
  VkSemaphore wait = VK_NULL_HANDLE;    // before all of its work
  VkSemaphore signal = VK_NULL_HANDLE;  // after all of its work
};

}  // namespace quintet::gpu
#endif
