// SPDX-License-Identifier: Apache-2.0
// Sizes in error messages of this layer, which are in MiB.
#ifndef QUINTET_GPU_MEBIBYTES_H
#define QUINTET_GPU_MEBIBYTES_H

#include "gpu/vulkan.h"

namespace quintet::gpu {

inline double mebibytes(VkDeviceSize bytes) { return static_cast<double>(bytes) / (1024.0 * 1024.0); }

}  // namespace quintet::gpu
#endif
