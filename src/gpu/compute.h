// SPDX-License-Identifier: Apache-2.0
// A compute pipeline with the layout of the bindless set, for film passes and tests of shader functions.
#ifndef QUINTET_GPU_COMPUTE_H
#define QUINTET_GPU_COMPUTE_H

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "base/hash.h"
#include "gpu/commands.h"
#include "gpu/descriptors.h"

namespace quintet::gpu {

class ComputePipeline {
 public:
  // The pipeline comes from Context::pipelines() if `cache` is null; otherwise it is created with `cache`. Throws
  // VulkanError.
  ComputePipeline(Context& context, const BindlessSet& set, std::span<const std::uint32_t> spirv, VkPipelineCache cache,
                  const std::string& name);
  ~ComputePipeline();
  ComputePipeline(const ComputePipeline&) = delete;
  ComputePipeline& operator=(const ComputePipeline&) = delete;

  // Binds pipeline and set, pushes `constants` (at most the set's pushConstantBytes) and dispatches workgroups.
  void dispatch(Commands& commands, std::span<const std::byte> constants, std::uint32_t groupsX,
                std::uint32_t groupsY = 1, std::uint32_t groupsZ = 1) const;

 private:
  Context& context_;
  const BindlessSet& set_;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  Hash key_;
  bool stored_ = false;  // whether Context::pipelines() owns the pipeline
};

}  // namespace quintet::gpu
#endif
