// SPDX-License-Identifier: Apache-2.0
// The only descriptor set: the TLAS and a bindless array of textures. Shaders access everything else by device address
// (docs/design/structure.md). Binding numbers are in shaders/quintet/shared/bindings.h.
#ifndef QUINTET_GPU_DESCRIPTORS_H
#define QUINTET_GPU_DESCRIPTORS_H

#include <cstdint>

#include "gpu/image.h"

namespace quintet::gpu {

// Binding 0 is an acceleration structure, binding 1 has `textureCount` combined image samplers (partially bound,
// non-uniformly indexed), and `pushConstantBytes` bytes of push constants are visible to all stages. Sets with
// different texture counts have compatible layouts, so they can share a pipeline.
class BindlessSet {
 public:
  BindlessSet(Context& context, std::uint32_t textureCount, std::uint32_t pushConstantBytes);
  ~BindlessSet();
  BindlessSet(const BindlessSet&) = delete;
  BindlessSet& operator=(const BindlessSet&) = delete;

  VkDescriptorSetLayout layout() const { return layout_; }
  VkPipelineLayout pipelineLayout() const { return pipelineLayout_; }
  VkDescriptorSet set() const { return set_; }
  std::uint32_t pushConstantBytes() const { return pushConstantBytes_; }
  // The stages of the bindings and the push constants. vkCmdPushConstants requires all of them.
  static VkShaderStageFlags stages();

  // Pending work must not use the set.
  void setAccelerationStructure(VkAccelerationStructureKHR structure);
  void setTexture(std::uint32_t index, const Image& image, const Sampler& sampler);
  // Sets all textures from `first` on.
  void fillTextures(std::uint32_t first, const Image& image, const Sampler& sampler);

 private:
  void release();
  Context& context_;
  VkDescriptorSetLayout layout_ = VK_NULL_HANDLE;
  VkPipelineLayout pipelineLayout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  std::uint32_t textureCount_ = 0;
  std::uint32_t pushConstantBytes_ = 0;
};

}  // namespace quintet::gpu
#endif
