// SPDX-License-Identifier: Apache-2.0
// The Vulkan Memory Allocator, for the .cpp files of src/gpu only. It loads its functions with vkGetInstanceProcAddr
// and vkGetDeviceProcAddr, so nothing links to the Vulkan loader.
#ifndef QUINTET_GPU_VMA_H
#define QUINTET_GPU_VMA_H

#include "gpu/vulkan.h"

#define VMA_STATIC_VULKAN_FUNCTIONS 0
#define VMA_DYNAMIC_VULKAN_FUNCTIONS 1
#define VMA_VULKAN_VERSION 1003000
#include <vk_mem_alloc.h>

#endif
