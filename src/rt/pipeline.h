// Ray tracing pipeline, its shader binding table on the device, and the trace itself.
#ifndef QUINTET_RT_PIPELINE_H
#define QUINTET_RT_PIPELINE_H

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/hash.h"
#include "gpu/commands.h"
#include "gpu/descriptors.h"
#include "gpu/pipeline_cache.h"
#include "rt/sbt_layout.h"
#include "shader/compiler.h"

namespace quintet::rt {

struct PipelineStage {
  shader::Stage stage = shader::Stage::rayGeneration;
  std::span<const std::uint32_t> spirv;
  std::string name;
};

inline constexpr int kNoStage = -1;

// A shader group: general (one of ray generation, miss, callable) or a hit group. Numbers are
// indices into PipelineOptions::stages.
struct PipelineGroup {
  int general = kNoStage;
  int closestHit = kNoStage;
  int anyHit = kNoStage;
  int intersection = kNoStage;  // set: a procedural hit group
  std::string name = {};        // for groupStackSizes
};

struct PipelineOptions {
  std::vector<PipelineStage> stages;
  std::vector<PipelineGroup> groups;
  std::uint32_t maxRecursionDepth = 1;
  std::string name;
  bool captureStatistics = false;  // for pipelineStatistics; where the driver can
};

class Pipeline {
 public:
  // Throws UsageError when the recursion depth exceeds the device's, VulkanError otherwise.
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
  VkPipeline handle_ = VK_NULL_HANDLE;  // of Context::pipelines()
  Hash key_;
  std::vector<std::byte> handles_;
  std::vector<PipelineGroup> groups_;
  bool keepsStatistics_ = false;
};

// The table on the device.
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

// Binds pipeline and set, pushes `constants` and launches width × height × depth rays. Throws
// UsageError beyond the device's limit of invocations. No barrier: the caller knows what follows.
void trace(gpu::Commands& commands, const Pipeline& pipeline, const ShaderBindingTable& table,
           std::span<const std::byte> constants, std::uint32_t width, std::uint32_t height, std::uint32_t depth = 1);

}  // namespace quintet::rt
#endif
