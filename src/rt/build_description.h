// Vulkan's description of one BLAS build, and the acceleration structure objects.
#ifndef QUINTET_RT_BUILD_DESCRIPTION_H
#define QUINTET_RT_BUILD_DESCRIPTION_H

#include "rt/geometry_data.h"

namespace quintet::rt {

struct BuildDescription {
  std::vector<VkAccelerationStructureGeometryKHR> geometries;
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges;
  VkAccelerationStructureTypeKHR type = VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR;
  VkBuildAccelerationStructureFlagsKHR flags = 0;

  // Points into `geometries`; destination and scratch are the caller's.
  VkAccelerationStructureBuildGeometryInfoKHR info(VkBuildAccelerationStructureModeKHR mode) const;
  // Throws MemoryError for a build that the driver cannot address.
  VkAccelerationStructureBuildSizesInfoKHR sizes(gpu::Context& context, const std::string& name) const;

  // Appends a geometry; addresses of its positions (or boxes) and triangles.
  void add(const GeometryData& data, VkDeviceAddress points, VkDeviceAddress triangles);
};

bool compacts(const gpu::Context& context, const BlasOptions& options);
VkBuildAccelerationStructureFlagsKHR buildFlags(const gpu::Context& context, const BlasOptions& options);

// With the input's counts and no addresses: an upper bound for sizes. Throws UsageError beyond the
// device's limits.
BuildDescription describeForSizes(const gpu::Context& context, const BlasInput& input);

// Makes a buffer of `size` bytes and an acceleration structure in it.
VkAccelerationStructureKHR createStructure(gpu::Context& context, gpu::Buffer& storage, VkDeviceSize size,
                                           VkAccelerationStructureTypeKHR type, const std::string& name);
void retireStructure(gpu::Context& context, VkAccelerationStructureKHR handle);
VkDeviceAddress structureAddress(gpu::Context& context, VkAccelerationStructureKHR handle);

}  // namespace quintet::rt
#endif
