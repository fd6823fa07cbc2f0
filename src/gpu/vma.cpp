// The one translation unit that holds the Vulkan Memory Allocator's code; its warnings are not ours.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#define VMA_IMPLEMENTATION
#include "gpu/vma.h"
#pragma GCC diagnostic pop
