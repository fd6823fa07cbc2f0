// Vulkan's declarations without prototypes: functions come from Context::vk() (a table per device,
// so that several devices can live in one process). Only this folder includes volk and VMA.
#ifndef QUINTET_GPU_VULKAN_H
#define QUINTET_GPU_VULKAN_H

#include <volk.h>

#endif
