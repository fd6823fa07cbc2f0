// The Vulkan Memory Allocator, for this folder's .cpp files only. It finds its functions by
// vkGetInstanceProcAddr and vkGetDeviceProcAddr, so nothing links to the Vulkan loader.
#ifndef QUINTET_GPU_VMA_H
#define QUINTET_GPU_VMA_H

#include "gpu/vulkan.h"

#define VMA_STATIC_VULKAN_FUNCTIONS 0
#define VMA_DYNAMIC_VULKAN_FUNCTIONS 1
#define VMA_VULKAN_VERSION 1003000
#include <vk_mem_alloc.h>

#endif
