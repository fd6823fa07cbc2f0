// SPDX-License-Identifier: Apache-2.0
#include "rt/tlas.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/plural.h"
#include "rt/acceleration_structure.h"
#include "rt/blas_builder.h"
#include "rt/spatial_order.h"

namespace quintet::rt {
namespace {

constexpr std::uint32_t kMax24Bits = (1u << 24) - 1;

void checkBits(const char* field, std::uint32_t value, std::uint32_t largest) {
  if (value > largest) throw UsageError(fmt::format("instance: {} is {}; the maximum is {}", field, value, largest));
}

// Inactive instances are replaced at the place of an active one, because some drivers fail on inactive instances, and on
// those with mask 0, among others (docs/design/quirks.md).
std::vector<VkAccelerationStructureInstanceKHR> packNumbered(std::span<const InstanceInput> instances,
                                                             const Blas* hidden) {
  std::vector<VkAccelerationStructureInstanceKHR> packed;
  const auto anyActive = std::ranges::find_if(instances, isActive);
  for (const InstanceInput& instance : instances) {
    packed.push_back(packInstance(instance));  // also checks instances that are skipped
    if (!isActive(instance) && anyActive != instances.end())
      packed.back() = packInstance({.worldFromObject = anyActive->worldFromObject, .blas = hidden});
  }
  if (anyActive == instances.end()) packed.clear();
  return packed;
}

// A degenerate triangle.
Blas buildHidden(gpu::Context& context) {
  const vec3 point(0.0f);
  const uvec3 triangle(0u);
  GeometryInput geometry;
  geometry.positions = {&point, 1};
  geometry.triangles = {&triangle, 1};
  const BlasInput input{.geometries = {geometry}, .options = {.name = "hidden"}};
  return std::move(BlasBuilder(context).build({&input, 1})[0]);
}

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

bool isActive(const InstanceInput& instance) {
  if (instance.mask == 0 || !instance.blas || instance.blas->bounds().empty()) return false;
  const mat4& m = instance.worldFromObject;
  for (glm::length_t column = 0; column < 4; ++column)
    if (!isFinite(vec3(m[column]))) return false;
  const float determinant = glm::determinant(mat3(m));
  return std::isfinite(determinant) && std::isfinite(1.0f / determinant);
}

VkAccelerationStructureInstanceKHR packInstance(const InstanceInput& instance) {
  checkBits("customIndex", instance.customIndex, kMax24Bits);
  checkBits("recordOffset", instance.recordOffset, kMax24Bits);
  checkBits("mask", instance.mask, 0xFF);
  checkBits("flags", instance.flags, 0xFF);
  VkAccelerationStructureInstanceKHR packed{};
  for (glm::length_t row = 0; row < 3; ++row)
    for (glm::length_t column = 0; column < 4; ++column)
      packed.transform.matrix[row][column] = instance.worldFromObject[column][row];
  packed.instanceCustomIndex = instance.customIndex & kMax24Bits;
  packed.mask = instance.mask & 0xFF;
  packed.instanceShaderBindingTableRecordOffset = instance.recordOffset & kMax24Bits;
  packed.flags = instance.flags & 0xFF;
  packed.accelerationStructureReference = instance.blas ? instance.blas->address() : 0;
  return packed;
}

std::vector<VkAccelerationStructureInstanceKHR> packInstances(std::span<const InstanceInput> instances,
                                                              InstanceOrder order, const Blas* hidden) {
  if (order == InstanceOrder::numbered) return packNumbered(instances, hidden);
  const bool spatial = order == InstanceOrder::spatial;
  std::vector<VkAccelerationStructureInstanceKHR> packed;
  std::vector<Bounds3> bounds;
  packed.reserve(instances.size());
  for (const InstanceInput& instance : instances) {
    const VkAccelerationStructureInstanceKHR one = packInstance(instance);  // also checks instances that are skipped
    if (!isActive(instance)) continue;
    packed.push_back(one);
    if (spatial) bounds.push_back(instance.blas->bounds().transformed(instance.worldFromObject));
  }
  if (!spatial) return packed;
  std::vector<VkAccelerationStructureInstanceKHR> ordered;
  ordered.reserve(packed.size());
  for (const std::uint32_t k : spatialOrder(bounds)) ordered.push_back(packed[k]);
  return ordered;
}

Tlas::Tlas(gpu::Context& context, std::uint32_t capacity, const std::string& name)
    : context_(context), capacity_(capacity), name_(name) {
  const gpu::RayTracingLimits& limits = context.info().limits;
  if (capacity > limits.maxInstances)
    throw UsageError(fmt::format("'{}' has a capacity of {} instances; the device supports {}", name, capacity,
                                 limits.maxInstances));
  const auto sizes = describe(0, capacity).sizes(context, name);
  scratch_ = gpu::Buffer(context, {.size = sizes.buildScratchSize,
                                   .alignment = limits.scratchAlignment,
                                   .name = name + " scratch",
                                   .purpose = gpu::Purpose::scratch});
  handle_ = createStructure(context, storage_, sizes.accelerationStructureSize,
                            VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, name);
}

Tlas::~Tlas() { retireStructure(context_, handle_); }

void Tlas::keepInputOrder(bool keep) {
  keepInputOrder_ = keep;
  if (keep && !hidden_) hidden_ = buildHidden(context_);
}

void Tlas::build(gpu::Commands& commands, std::span<const InstanceInput> instances) {
  if (instances.size() > capacity_)
    throw UsageError(fmt::format("'{}' cannot hold {}; its capacity is {}", name_,
                                 counted(instances.size(), "instance"), capacity_));
  const InstanceOrder order = keepInputOrder_                              ? InstanceOrder::numbered
                              : context_.info().quirks.keepsPrimitiveOrder ? InstanceOrder::spatial
                                                                           : InstanceOrder::given;
  const std::vector<VkAccelerationStructureInstanceKHR> packed =
      packInstances(instances, order, hidden_ ? &*hidden_ : nullptr);
  const std::span<const std::byte> bytes = std::as_bytes(std::span(packed));
  // The buffer is freed after this submission, so any number of rebuilds can be pending.
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
  // Wait for earlier traces and BLAS builds, and for earlier uses of the scratch buffer.
  commands.barrier(gpu::Stage::all, gpu::Stage::accelerationStructureBuild);
  context_.vk().vkCmdBuildAccelerationStructuresKHR(commands.handle(), 1, &info, &ranges);
  commands.barrier(gpu::Stage::accelerationStructureBuild, gpu::Stage::all);
}

void Tlas::buildAndWait(std::span<const InstanceInput> instances) {
  context_.submitAndWait([&](gpu::Commands& commands) { build(commands, instances); });
}

}  // namespace quintet::rt
