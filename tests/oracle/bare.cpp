// SPDX-License-Identifier: Apache-2.0
#include "bare.h"

#include <algorithm>

#include "gpu/error.h"
#include "harness.h"
#include "rt/acceleration_structure.h"

namespace quintet::oracle {
namespace {

gpu::Context& context() { return test::testContext(); }
const VolkDeviceTable& vk() { return context().vk(); }

constexpr VkBufferUsageFlags kBuildInput = VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;

VkAccelerationStructureGeometryKHR describe(const BareGeometry& g, VkDeviceAddress points, VkDeviceAddress indices) {
  VkAccelerationStructureGeometryKHR geometry{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  geometry.flags = g.flags;
  if (!g.boxes.empty()) {
    geometry.geometryType = VK_GEOMETRY_TYPE_AABBS_KHR;
    auto& boxes = geometry.geometry.aabbs;
    boxes.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_AABBS_DATA_KHR;
    boxes.data.deviceAddress = points;
    boxes.stride = sizeof(Bounds3);
    return geometry;
  }
  geometry.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
  auto& triangles = geometry.geometry.triangles;
  triangles.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR;
  triangles.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
  triangles.vertexData.deviceAddress = points;
  triangles.vertexStride = sizeof(vec3);
  triangles.maxVertex = static_cast<std::uint32_t>(g.positions.size() - 1);
  triangles.indexType = g.indices.empty() ? VK_INDEX_TYPE_NONE_KHR : VK_INDEX_TYPE_UINT32;
  triangles.indexData.deviceAddress = g.indices.empty() ? 0 : indices;
  return geometry;
}

}  // namespace

BareStructure::BareStructure(const std::vector<BareGeometry>& geometries, bool compactable) {
  std::vector<gpu::Buffer> inputs;
  std::vector<VkAccelerationStructureGeometryKHR> descriptions;
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges;
  for (const BareGeometry& g : geometries) {
    const gpu::Buffer& points =
        inputs.emplace_back(g.boxes.empty() ? gpu::makeBufferOf(context(), g.positions, kBuildInput, "bare positions")
                                            : gpu::makeBufferOf(context(), g.boxes, kBuildInput, "bare boxes"));
    const VkDeviceAddress pointsAt = points.address();
    const VkDeviceAddress indicesAt =
        inputs.emplace_back(gpu::makeBufferOf(context(), g.indices, kBuildInput, "bare indices")).address();
    descriptions.push_back(describe(g, pointsAt, indicesAt));
    ranges.push_back({g.primitiveCount, g.primitiveOffset, g.firstVertex, 0});
  }
  build(VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, descriptions, ranges, compactable);
}

BareStructure::BareStructure(const std::vector<VkAccelerationStructureInstanceKHR>& instances) {
  const gpu::Buffer input = gpu::makeBufferOf(context(), instances, kBuildInput, "bare instances");
  VkAccelerationStructureGeometryKHR geometry{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  geometry.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
  geometry.geometry.instances.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR;
  geometry.geometry.instances.data.deviceAddress = input.address();
  build(VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, {geometry},
        {{static_cast<std::uint32_t>(instances.size()), 0, 0, 0}}, false);
}

void BareStructure::build(VkAccelerationStructureTypeKHR type,
                          const std::vector<VkAccelerationStructureGeometryKHR>& geometries,
                          const std::vector<VkAccelerationStructureBuildRangeInfoKHR>& ranges, bool compactable) {
  VkAccelerationStructureBuildGeometryInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
  info.type = type;
  if (compactable) info.flags = VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_COMPACTION_BIT_KHR;
  info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  info.geometryCount = static_cast<std::uint32_t>(geometries.size());
  info.pGeometries = geometries.data();
  std::vector<std::uint32_t> counts;
  for (const auto& range : ranges) counts.push_back(range.primitiveCount);
  VkAccelerationStructureBuildSizesInfoKHR sizes{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
  vk().vkGetAccelerationStructureBuildSizesKHR(context().device(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR,
                                               &info, counts.data(), &sizes);
  handle_ = rt::createStructure(context(), storage_, sizes.accelerationStructureSize, type, "bare structure");
  const gpu::Buffer scratch(
      context(),
      {.size = sizes.buildScratchSize, .alignment = context().info().limits.scratchAlignment, .name = "bare scratch"});
  info.dstAccelerationStructure = handle_;
  info.scratchData.deviceAddress = scratch.address();
  context().submitAndWait([&](gpu::Commands& commands) {
    const VkAccelerationStructureBuildRangeInfoKHR* first = ranges.data();
    vk().vkCmdBuildAccelerationStructuresKHR(commands.handle(), 1, &info, &first);
  });
}

BareStructure::~BareStructure() { rt::retireStructure(context(), handle_); }

VkDeviceAddress BareStructure::address() const { return rt::structureAddress(context(), handle_); }

VkDeviceSize BareStructure::compactedSize() const {
  VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
  info.queryType = VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR;
  info.queryCount = 1;
  VkQueryPool pool = VK_NULL_HANDLE;
  gpu::check(vk().vkCreateQueryPool(context().device(), &info, nullptr, &pool), "create a query");
  context().submitAndWait([&](gpu::Commands& commands) {
    vk().vkCmdResetQueryPool(commands.handle(), pool, 0, 1);
    vk().vkCmdWriteAccelerationStructuresPropertiesKHR(commands.handle(), 1, &handle_, info.queryType, pool, 0);
  });
  VkDeviceSize size = 0;
  const VkResult result = vk().vkGetQueryPoolResults(context().device(), pool, 0, 1, sizeof size, &size, sizeof size,
                                                     VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
  vk().vkDestroyQueryPool(context().device(), pool, nullptr);
  gpu::check(result, "read the compacted size");
  return size;
}

VkAccelerationStructureInstanceKHR bareInstance(VkDeviceAddress blas, std::uint32_t recordOffset) {
  VkAccelerationStructureInstanceKHR instance{};
  for (int k = 0; k < 3; ++k) instance.transform.matrix[k][k] = 1.0f;
  instance.mask = 0xFF;
  instance.instanceShaderBindingTableRecordOffset = recordOffset & 0xFFFFFF;
  instance.accelerationStructureReference = blas;
  return instance;
}

BarePipeline::BarePipeline(const std::vector<BareStage>& stages, const std::vector<BareGroup>& groups,
                           VkPipelineCreateFlags flags, const std::vector<VkPipeline>& libraries,
                           VkPipelineCache cache) {
  std::vector<VkPipelineShaderStageCreateInfo> stageInfos;
  for (const BareStage& stage : stages) {
    VkShaderModuleCreateInfo module{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    module.codeSize = stage.spirv.size() * 4;
    module.pCode = stage.spirv.data();
    VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    info.stage = stage.stage;
    info.pName = "main";
    gpu::check(vk().vkCreateShaderModule(context().device(), &module, nullptr, &info.module), "create a shader module");
    stageInfos.push_back(info);
  }
  std::vector<VkRayTracingShaderGroupCreateInfoKHR> groupInfos;
  for (const BareGroup& group : groups) {
    VkRayTracingShaderGroupCreateInfoKHR info{VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR};
    info.type = group.general != VK_SHADER_UNUSED_KHR        ? VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR
                : group.intersection != VK_SHADER_UNUSED_KHR ? VK_RAY_TRACING_SHADER_GROUP_TYPE_PROCEDURAL_HIT_GROUP_KHR
                                                             : VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR;
    info.generalShader = group.general;
    info.closestHitShader = group.closestHit;
    info.anyHitShader = group.anyHit;
    info.intersectionShader = group.intersection;
    groupInfos.push_back(info);
  }
  VkPipelineLibraryCreateInfoKHR library{VK_STRUCTURE_TYPE_PIPELINE_LIBRARY_CREATE_INFO_KHR};
  library.libraryCount = static_cast<std::uint32_t>(libraries.size());
  library.pLibraries = libraries.data();
  VkRayTracingPipelineInterfaceCreateInfoKHR interface {
    VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_INTERFACE_CREATE_INFO_KHR
  };
  interface.maxPipelineRayPayloadSize = 64;
  interface.maxPipelineRayHitAttributeSize = 8;
  VkRayTracingPipelineCreateInfoKHR info{VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR};
  info.flags = flags;
  info.stageCount = static_cast<std::uint32_t>(stageInfos.size());
  info.pStages = stageInfos.data();
  info.groupCount = static_cast<std::uint32_t>(groupInfos.size());
  info.pGroups = groupInfos.data();
  info.maxPipelineRayRecursionDepth = 1;
  info.layout = Program::set().pipelineLayout();
  if (!libraries.empty()) info.pLibraryInfo = &library;
  if (!libraries.empty() || (flags & VK_PIPELINE_CREATE_LIBRARY_BIT_KHR)) info.pLibraryInterface = &interface;
  const VkResult result =
      vk().vkCreateRayTracingPipelinesKHR(context().device(), VK_NULL_HANDLE, cache, 1, &info, nullptr, &handle_);
  for (const auto& stage : stageInfos) vk().vkDestroyShaderModule(context().device(), stage.module, nullptr);
  gpu::check(result, "create a bare pipeline");
}

BarePipeline::~BarePipeline() { vk().vkDestroyPipeline(context().device(), handle_, nullptr); }

std::vector<std::byte> BarePipeline::groupHandles(std::uint32_t count) const {
  std::vector<std::byte> handles(std::size_t{count} * context().info().limits.handleSize);
  gpu::check(
      vk().vkGetRayTracingShaderGroupHandlesKHR(context().device(), handle_, 0, count, handles.size(), handles.data()),
      "get the group handles");
  return handles;
}

BareTable::BareTable(const rt::SbtContents& contents, std::span<const std::byte> handles) {
  const gpu::RayTracingLimits& limits = context().info().limits;
  const rt::SbtLayout layout = rt::layoutSbt(contents, limits);
  const std::vector<std::byte> bytes = rt::fillSbt(contents, layout, handles, limits);
  buffer = gpu::Buffer(context(), {.size = bytes.size(),
                                   .usage = VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR,
                                   .alignment = limits.baseAlignment,
                                   .name = "bare table"});
  buffer.upload(bytes);
  const auto region = [&](const rt::SbtRegion& r) {
    return r.size ? VkStridedDeviceAddressRegionKHR{buffer.address() + r.offset, r.stride, r.size}
                  : VkStridedDeviceAddressRegionKHR{};
  };
  regions = {region(layout.rayGeneration), region(layout.miss), region(layout.hit), region(layout.callable)};
}

std::vector<std::byte> bareTrace(VkPipeline pipeline, const BareRegions& regions, VkAccelerationStructureKHR tlas,
                                 std::span<const std::byte> inputs, std::uint32_t count, std::size_t outputSize) {
  const gpu::Buffer inputBuffer = gpu::makeBuffer(context(), inputs, 0, "bare inputs");
  const gpu::Buffer outputBuffer =
      gpu::makeBufferOf(context(), std::vector<std::byte>(count * outputSize), 0, "bare outputs");
  gpu::BindlessSet& set = Program::set();
  set.setAccelerationStructure(tlas);
  const LaunchConstants constants{inputBuffer.address(), outputBuffer.address(), {}, {}};
  const VkDescriptorSet descriptors = set.set();
  context().wait(context().submit([&](gpu::Commands& commands) {
    vk().vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, pipeline);
    vk().vkCmdBindDescriptorSets(commands.handle(), VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, set.pipelineLayout(), 0, 1,
                                 &descriptors, 0, nullptr);
    vk().vkCmdPushConstants(commands.handle(), set.pipelineLayout(), gpu::BindlessSet::stages(), 0, sizeof constants,
                            &constants);
    vk().vkCmdTraceRaysKHR(commands.handle(), &regions.rayGeneration, &regions.miss, &regions.hit, &regions.callable,
                           count, 1, 1);
  }),
                 120.0);
  return outputBuffer.downloadAs<std::byte>(count * outputSize);
}

}  // namespace quintet::oracle
