// SPDX-License-Identifier: Apache-2.0
// Acceleration structure objects, and Vulkan's description of one build; for both levels.
#ifndef QUINTET_RT_ACCELERATION_STRUCTURE_H
#define QUINTET_RT_ACCELERATION_STRUCTURE_H

#include <string>
#include <vector>

#include "gpu/buffer.h"
#include "rt/blas_input.h"

namespace quintet::rt {

struct BuildDescription {
  std::vector<VkAccelerationStructureGeometryKHR> geometries;
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges;
  VkAccelerationStructureTypeKHR type = VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR;
  VkBuildAccelerationStructureFlagsKHR flags = 0;

  // The result points into `geometries`. The caller sets destination and scratch.
  VkAccelerationStructureBuildGeometryInfoKHR info(VkBuildAccelerationStructureModeKHR mode) const;
  // Throws MemoryError for a build that the driver cannot address.
  VkAccelerationStructureBuildSizesInfoKHR sizes(gpu::Context& context, const std::string& name) const;

  // Appends a geometry with the addresses of its positions (or boxes) and triangles.
  void add(const GeometryData& data, VkDeviceAddress points, VkDeviceAddress triangles);
};

// Returns whether a BLAS with these options is compacted on this device.
bool isCompacted(const gpu::Context& context, const BlasOptions& options);
VkBuildAccelerationStructureFlagsKHR buildFlags(const gpu::Context& context, const BlasOptions& options);

// Returns a description with the counts of the input and without addresses, for an upper bound of the sizes. Throws
// UsageError for inputs above the limits of the device and for mixed kinds.
BuildDescription describeForSizes(const gpu::Context& context, const BlasInput& input);

// Creates a buffer of `size` bytes and an acceleration structure in it.
VkAccelerationStructureKHR createStructure(gpu::Context& context, gpu::Buffer& storage, VkDeviceSize size,
                                           VkAccelerationStructureTypeKHR type, const std::string& name);
void retireStructure(gpu::Context& context, VkAccelerationStructureKHR handle);
VkDeviceAddress structureAddress(gpu::Context& context, VkAccelerationStructureKHR handle);

}  // namespace quintet::rt
#endif
