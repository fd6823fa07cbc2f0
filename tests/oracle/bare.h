// SPDX-License-Identifier: Apache-2.0
// Vulkan without the workarounds of the library, for tests of the driver itself.
#ifndef QUINTET_TESTS_ORACLE_BARE_H
#define QUINTET_TESTS_ORACLE_BARE_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "program.h"

namespace quintet::oracle {

// One geometry, built without removing, sorting or checking primitives.
struct BareGeometry {
  std::vector<vec3> positions = {};
  std::vector<std::uint32_t> indices = {};  // empty means three positions per triangle
  std::vector<Bounds3> boxes = {};          // makes it a geometry of boxes
  std::uint32_t primitiveCount = 0;
  std::uint32_t primitiveOffset = 0;  // bytes
  std::uint32_t firstVertex = 0;
  VkGeometryFlagsKHR flags = VK_GEOMETRY_OPAQUE_BIT_KHR;
};

class BareStructure {
 public:
  explicit BareStructure(const std::vector<BareGeometry>& geometries, bool compactable = false);
  explicit BareStructure(const std::vector<VkAccelerationStructureInstanceKHR>& instances);
  ~BareStructure();
  BareStructure(const BareStructure&) = delete;
  BareStructure& operator=(const BareStructure&) = delete;
  VkAccelerationStructureKHR handle() const { return handle_; }
  VkDeviceAddress address() const;
  VkDeviceSize size() const { return storage_.size(); }
  VkDeviceSize compactedSize() const;

 private:
  void build(VkAccelerationStructureTypeKHR type, const std::vector<VkAccelerationStructureGeometryKHR>& geometries,
             const std::vector<VkAccelerationStructureBuildRangeInfoKHR>& ranges, bool compactable);
  gpu::Buffer storage_;
  VkAccelerationStructureKHR handle_ = VK_NULL_HANDLE;
};

// Returns an instance with the identity transform, all mask bits and no flags.
VkAccelerationStructureInstanceKHR bareInstance(VkDeviceAddress blas, std::uint32_t recordOffset = 0);

// A pipeline with exactly the given stages and groups.
struct BareStage {
  VkShaderStageFlagBits stage;
  std::vector<std::uint32_t> spirv;
};
struct BareGroup {  // indices of stages
  std::uint32_t general = VK_SHADER_UNUSED_KHR, closestHit = VK_SHADER_UNUSED_KHR, anyHit = VK_SHADER_UNUSED_KHR,
                intersection = VK_SHADER_UNUSED_KHR;
};
class BarePipeline {
 public:
  BarePipeline(const std::vector<BareStage>& stages, const std::vector<BareGroup>& groups,
               VkPipelineCreateFlags flags = 0, const std::vector<VkPipeline>& libraries = {},
               VkPipelineCache cache = VK_NULL_HANDLE);
  ~BarePipeline();
  BarePipeline(const BarePipeline&) = delete;
  BarePipeline& operator=(const BarePipeline&) = delete;
  VkPipeline handle() const { return handle_; }
  std::vector<std::byte> groupHandles(std::uint32_t count) const;

 private:
  VkPipeline handle_ = VK_NULL_HANDLE;
};

// Device addresses of the four tables.
struct BareRegions {
  VkStridedDeviceAddressRegionKHR rayGeneration{}, miss{}, hit{}, callable{};
};
// Tables with the layout of rt::layoutSbt and the handles of a bare pipeline.
struct BareTable {
  BareTable(const rt::SbtContents& contents, std::span<const std::byte> handles);
  gpu::Buffer buffer;
  BareRegions regions;
};
// Runs one invocation per input with the push constants of program.h.
std::vector<std::byte> bareTrace(VkPipeline pipeline, const BareRegions& regions, VkAccelerationStructureKHR tlas,
                                 std::span<const std::byte> inputs, std::uint32_t count, std::size_t outputSize);

}  // namespace quintet::oracle
#endif
