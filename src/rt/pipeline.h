// SPDX-License-Identifier: Apache-2.0
// Ray tracing pipelines, their shader binding tables on the device, their statistics, and traces.
#ifndef QUINTET_RT_PIPELINE_H
#define QUINTET_RT_PIPELINE_H

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "gpu/commands.h"
#include "gpu/descriptors.h"
#include "gpu/pipeline_cache.h"
#include "rt/sbt_layout.h"

namespace quintet::rt {

struct PipelineStage {
  VkShaderStageFlagBits stage = VK_SHADER_STAGE_RAYGEN_BIT_KHR;
  std::span<const std::uint32_t> spirv;
  std::string name;
};

inline constexpr int kNoStage = -1;

// A shader group: general (ray generation, miss or callable) or a hit group. The members are indices of
// PipelineOptions::stages.
struct PipelineGroup {
  int general = kNoStage;
  int closestHit = kNoStage;
  int anyHit = kNoStage;
  int intersection = kNoStage;  // makes it a procedural hit group
  std::string name = {};        // for groupStackSizes
};

struct PipelineOptions {
  std::vector<PipelineStage> stages;
  std::vector<PipelineGroup> groups;
  std::uint32_t maxRecursionDepth = 1;
  std::string name;
  bool captureStatistics = false;  // for pipelineStatistics, if the driver supports it
};

class Pipeline {
 public:
  // Throws UsageError without a ray generation group or if the device does not support the recursion depth, VulkanError
  // for failures of the driver.
  Pipeline(gpu::Context& context, const gpu::BindlessSet& set, const PipelineOptions& options,
           const gpu::PipelineCache* cache);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  VkPipeline handle() const { return handle_; }
  const gpu::BindlessSet& set() const { return set_; }
  std::span<const std::byte> groupHandles() const { return handles_; }
  const std::vector<PipelineGroup>& groups() const { return groups_; }
  gpu::Context& context() const { return context_; }
  bool keepsStatistics() const { return keepsStatistics_; }  // for pipelineStatistics

 private:
  gpu::Context& context_;
  const gpu::BindlessSet& set_;
  VkPipeline handle_ = VK_NULL_HANDLE;  // owned by Context::pipelines()
  Hash key_;
  std::vector<std::byte> handles_;
  std::vector<PipelineGroup> groups_;
  bool keepsStatistics_ = false;
};

// A shader binding table on the device.
class ShaderBindingTable {
 public:
  ShaderBindingTable(gpu::Context& context, const Pipeline& pipeline, const SbtContents& contents,
                     const std::string& name);
  const SbtLayout& layout() const { return layout_; }
  VkStridedDeviceAddressRegionKHR region(const SbtRegion& region) const;

 private:
  gpu::Buffer buffer_;
  SbtLayout layout_;
};

// Launches no invocations: a driver that compiles for the first launch of a pipeline does it then.
void traceNothing(gpu::Commands& commands, const Pipeline& pipeline, const ShaderBindingTable& table);

// Binds pipeline and set, pushes `constants` and launches width × height × depth rays, without barriers. Throws
// UsageError for more invocations than the device supports.
void trace(gpu::Commands& commands, const Pipeline& pipeline, const ShaderBindingTable& table,
           std::span<const std::byte> constants, std::uint32_t width, std::uint32_t height, std::uint32_t depth = 1);

// One piece of machine code of a pipeline (VK_KHR_pipeline_executable_properties): registers, stack, code size. The
// driver decides which statistics exist and how they are named.
struct PipelineExecutable {
  std::string name;
  std::uint32_t subgroupSize = 0;
  std::vector<std::pair<std::string, double>> statistics;
};

// Returns an empty list if the device does not support it (DeviceInfo::pipelineStatistics) or the pipeline was created
// without captureStatistics.
std::vector<PipelineExecutable> pipelineStatistics(const Pipeline& pipeline);

// Returns the bytes of stack that one call of each group needs, with the name of the group. For hit groups it is the
// largest of the group's shaders.
std::vector<std::pair<std::string, std::uint64_t>> groupStackSizes(const Pipeline& pipeline);

}  // namespace quintet::rt
#endif
