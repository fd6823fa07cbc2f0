#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "rt/build_description.h"
#include "rt/instance_data.h"

namespace quintet::rt {
namespace {

BuildDescription describe(VkDeviceAddress instances, std::uint32_t count) {
  BuildDescription description;
  description.type = VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR;
  description.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
  VkAccelerationStructureGeometryKHR geometry{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  geometry.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
  geometry.geometry.instances.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR;
  geometry.geometry.instances.data.deviceAddress = instances;
  description.geometries.push_back(geometry);
  description.ranges.push_back({.primitiveCount = count, .primitiveOffset = 0, .firstVertex = 0, .transformOffset = 0});
  return description;
}

}  // namespace

Tlas::Tlas(gpu::Context& context, std::uint32_t capacity, const std::string& name)
    : context_(context), capacity_(capacity), name_(name) {
  const gpu::RayTracingLimits& limits = context.info().limits;
  if (capacity > limits.maxInstances)
    throw UsageError(fmt::format("'{}' for {} instances: the device allows {}", name, capacity, limits.maxInstances));
  const auto sizes = describe(0, capacity).sizes(context, name);
  scratch_ = gpu::Buffer(context, {.size = sizes.buildScratchSize,
                                   .alignment = limits.scratchAlignment,
                                   .name = name + " scratch",
                                   .purpose = gpu::Purpose::scratch});
  handle_ = createStructure(context, storage_, sizes.accelerationStructureSize,
                            VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, name);
}

Tlas::~Tlas() { retireStructure(context_, handle_); }

void Tlas::build(gpu::Commands& commands, std::span<const InstanceInput> instances) {
  if (instances.size() > capacity_)
    throw UsageError(fmt::format("'{}' has room for {} instances, {} were given", name_, capacity_, instances.size()));
  const InstanceOrder order = keepInputOrder_                              ? InstanceOrder::numbered
                              : context_.info().quirks.keepsPrimitiveOrder ? InstanceOrder::spatial
                                                                           : InstanceOrder::given;
  const std::vector<VkAccelerationStructureInstanceKHR> packed = packInstances(instances, order);
  const std::span<const std::byte> bytes = std::as_bytes(std::span(packed));
  // Freed when this submission has ended: no ring to run out of, whatever is in flight.
  const gpu::Buffer buffer(context_,
                           {.size = std::max<VkDeviceSize>(bytes.size(), sizeof(VkAccelerationStructureInstanceKHR)),
                            .memory = gpu::Memory::upload,
                            .usage = VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR,
                            .name = name_ + " instances"});
  if (!bytes.empty()) std::memcpy(buffer.mapped(), bytes.data(), bytes.size());

  const BuildDescription description = describe(buffer.address(), static_cast<std::uint32_t>(packed.size()));
  auto info = description.info(VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR);
  info.dstAccelerationStructure = handle_;
  info.scratchData.deviceAddress = scratch_.address();
  const VkAccelerationStructureBuildRangeInfoKHR* ranges = description.ranges.data();
  commands.barrier(gpu::Stage::all,
                   gpu::Stage::accelerationStructureBuild);  // earlier traces, BLAS builds, our scratch
  context_.vk().vkCmdBuildAccelerationStructuresKHR(commands.handle(), 1, &info, &ranges);
  commands.barrier(gpu::Stage::accelerationStructureBuild, gpu::Stage::all);
}

void Tlas::buildAndWait(std::span<const InstanceInput> instances) {
  context_.submitAndWait([&](gpu::Commands& commands) { build(commands, instances); });
}

}  // namespace quintet::rt
