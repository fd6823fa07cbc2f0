#include "rt/instance_data.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "rt/spatial_order.h"

namespace quintet::rt {
namespace {

constexpr std::uint32_t kMax24Bits = (1u << 24) - 1;

void checkBits(const char* field, std::uint32_t value, std::uint32_t largest) {
  if (value > largest)
    throw UsageError(fmt::format("instance: {} is {}, at most {} is possible", field, value, largest));
}

}  // namespace

bool isActive(const InstanceInput& instance) {
  if (!instance.blas || instance.blas->bounds().empty()) return false;
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

namespace {

// Nothing that a ray could meet, in the place of an inactive instance. Its transform is plain, and its structure is
// one with primitives: drivers exist that stumble over inactive instances in a build.
VkAccelerationStructureInstanceKHR placeholder(const InstanceInput& active) {
  InstanceInput hidden;
  hidden.worldFromObject = active.worldFromObject;
  hidden.blas = active.blas;
  hidden.mask = 0;
  return packInstance(hidden);
}

std::vector<VkAccelerationStructureInstanceKHR> packNumbered(std::span<const InstanceInput> instances) {
  std::vector<VkAccelerationStructureInstanceKHR> packed;
  const auto anyActive = std::ranges::find_if(instances, isActive);
  for (const InstanceInput& instance : instances) {
    packed.push_back(packInstance(instance));  // checks those that are left out, too
    if (!isActive(instance) && anyActive != instances.end()) packed.back() = placeholder(*anyActive);
  }
  if (anyActive == instances.end()) packed.clear();
  return packed;
}

}  // namespace

std::vector<VkAccelerationStructureInstanceKHR> packInstances(std::span<const InstanceInput> instances,
                                                              InstanceOrder order) {
  if (order == InstanceOrder::numbered) return packNumbered(instances);
  const bool spatial = order == InstanceOrder::spatial;
  std::vector<VkAccelerationStructureInstanceKHR> packed;
  std::vector<Bounds3> bounds;
  packed.reserve(instances.size());
  for (const InstanceInput& instance : instances) {
    const VkAccelerationStructureInstanceKHR one = packInstance(instance);  // checks those that are left out, too
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

}  // namespace quintet::rt
