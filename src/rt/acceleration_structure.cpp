// SPDX-License-Identifier: Apache-2.0
#include "rt/acceleration_structure.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "gpu/error.h"

namespace quintet::rt {

static_assert(sizeof(Bounds3) == sizeof(VkAabbPositionsKHR) && sizeof(vec3) == 12 && sizeof(uvec3) == 12);

void BuildDescription::add(const GeometryData& data, VkDeviceAddress points, VkDeviceAddress triangles) {
  VkAccelerationStructureGeometryKHR geometry{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  geometry.flags = data.flags;
  const std::span<const vec3> positions = data.input.positions;
  if (data.input.kind == GeometryKind::triangles) {
    geometry.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
    auto& out = geometry.geometry.triangles;
    out.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR;
    out.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
    out.vertexData.deviceAddress = points;
    out.vertexStride = sizeof(vec3);
    out.maxVertex = positions.empty() ? 0 : static_cast<std::uint32_t>(positions.size() - 1);
    out.indexType = VK_INDEX_TYPE_UINT32;
    out.indexData.deviceAddress = triangles;
  } else {
    geometry.geometryType = VK_GEOMETRY_TYPE_AABBS_KHR;
    auto& out = geometry.geometry.aabbs;
    out.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_AABBS_DATA_KHR;
    out.data.deviceAddress = points;
    out.stride = sizeof(Bounds3);
  }
  geometries.push_back(geometry);
  // firstVertex must be 0 because lavapipe applies it twice (docs/design/quirks.md). Offsets are part of the addresses.
  ranges.push_back({.primitiveCount = data.count, .primitiveOffset = 0, .firstVertex = 0, .transformOffset = 0});
}

VkAccelerationStructureBuildGeometryInfoKHR BuildDescription::info(VkBuildAccelerationStructureModeKHR mode) const {
  VkAccelerationStructureBuildGeometryInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
  info.type = type;
  info.flags = flags;
  info.mode = mode;
  info.geometryCount = static_cast<std::uint32_t>(geometries.size());
  info.pGeometries = geometries.data();
  return info;
}

VkAccelerationStructureBuildSizesInfoKHR BuildDescription::sizes(gpu::Context& context, const std::string& name) const {
  const auto buildInfo = info(VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR);
  std::vector<std::uint32_t> counts;
  std::uint64_t total = 0;
  for (const auto& range : ranges) {
    counts.push_back(range.primitiveCount);
    total += range.primitiveCount;
  }
  VkAccelerationStructureBuildSizesInfoKHR sizes{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
  context.vk().vkGetAccelerationStructureBuildSizesKHR(
      context.device(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &buildInfo, counts.data(), &sizes);
  // lavapipe (Mesa 25.0) counts bytes with 32 bits: above 4 GiB the reported size is too small, and the build would
  // write behind the end of the buffer. Every structure needs at least 12 bytes per primitive.
  constexpr std::uint64_t kLavapipeMaxPrimitives = (std::uint64_t{1} << 32) / 160;
  const bool overflows = context.info().software && total > kLavapipeMaxPrimitives;
  if (overflows || sizes.accelerationStructureSize < 12 * total)
    throw MemoryError(
        fmt::format("'{}': {} primitives are too many for one acceleration structure with this driver", name, total));
  return sizes;
}

bool isCompacted(const gpu::Context& context, const BlasOptions& options) {
  return options.compact && !options.allowUpdate && !context.info().quirks.noCompaction;
}

VkBuildAccelerationStructureFlagsKHR buildFlags(const gpu::Context& context, const BlasOptions& options) {
  VkBuildAccelerationStructureFlagsKHR flags = options.fastTrace
                                                   ? VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR
                                                   : VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_BUILD_BIT_KHR;
  if (options.allowUpdate) flags |= VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_UPDATE_BIT_KHR;
  if (isCompacted(context, options)) flags |= VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_COMPACTION_BIT_KHR;
  return flags;
}

BuildDescription describeForSizes(const gpu::Context& context, const BlasInput& input) {
  const gpu::RayTracingLimits& limits = context.info().limits;
  BuildDescription description;
  description.flags = buildFlags(context, input.options);
  std::uint64_t total = 0;
  for (const GeometryInput& geometry : input.geometries) {
    if (geometry.kind != input.geometries[0].kind)
      throw UsageError(fmt::format("BLAS '{}' mixes triangles and boxes", input.options.name));
    total += primitiveCount(geometry);
    if (total > limits.maxPrimitives || geometry.positions.size() > limits.maxPrimitives * 3)
      throw UsageError(fmt::format("BLAS '{}' has more primitives than the device supports ({})", input.options.name,
                                   limits.maxPrimitives));
    description.add(applyMap(geometry, {}, primitiveCount(geometry)), 0, 0);
  }
  if (input.geometries.size() > limits.maxGeometries)
    throw UsageError(fmt::format("BLAS '{}' has {} geometries; the device supports {}", input.options.name,
                                 input.geometries.size(), limits.maxGeometries));
  return description;
}

VkAccelerationStructureKHR createStructure(gpu::Context& context, gpu::Buffer& storage, VkDeviceSize size,
                                           VkAccelerationStructureTypeKHR type, const std::string& name) {
  storage = gpu::Buffer(context, {.size = size,
                                  .usage = VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR,
                                  .name = name,
                                  .purpose = gpu::Purpose::accelerationStructures});
  VkAccelerationStructureCreateInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR};
  info.buffer = storage.handle();
  info.size = size;
  info.type = type;
  VkAccelerationStructureKHR handle = VK_NULL_HANDLE;
  gpu::check(context.vk().vkCreateAccelerationStructureKHR(context.device(), &info, nullptr, &handle),
             "create the acceleration structure", name);
  context.setName(VK_OBJECT_TYPE_ACCELERATION_STRUCTURE_KHR, reinterpret_cast<std::uint64_t>(handle), name);
  return handle;
}

void retireStructure(gpu::Context& context, VkAccelerationStructureKHR handle) {
  context.retire(
      [&context, handle] { context.vk().vkDestroyAccelerationStructureKHR(context.device(), handle, nullptr); });
}

VkDeviceAddress structureAddress(gpu::Context& context, VkAccelerationStructureKHR handle) {
  VkAccelerationStructureDeviceAddressInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR};
  info.accelerationStructure = handle;
  return context.vk().vkGetAccelerationStructureDeviceAddressKHR(context.device(), &info);
}

}  // namespace quintet::rt
