// SPDX-License-Identifier: Apache-2.0
// Vulkan's declarations without prototypes. Functions come from Context::vk(), a table per device, so that one process
// can use several devices. Only src/gpu includes volk and VMA.
#ifndef QUINTET_GPU_VULKAN_H
#define QUINTET_GPU_VULKAN_H

#include <volk.h>

#endif
