// SPDX-License-Identifier: Apache-2.0
// Implementation of the Vulkan Memory Allocator, compiled without warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#define VMA_IMPLEMENTATION
#include "gpu/vma.h"
#pragma GCC diagnostic pop
