// The one descriptor set of the project: the TLAS and a bindless array of textures. Everything else
// reaches shaders by device address (docs/design/structure.md). Binding numbers: shaders/quintet/shared/bindings.h.
#ifndef QUINTET_GPU_DESCRIPTORS_H
#define QUINTET_GPU_DESCRIPTORS_H

#include "gpu/image.h"

namespace quintet::gpu {

// Layout: binding 0 an acceleration structure, binding 1 `textureCount` combined image samplers
// (partially bound, non-uniformly indexed); push constants of `pushConstantBytes` for all stages.
// Sets of any two texture counts have compatible layouts: a pipeline made with one works with the other.
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
  static VkShaderStageFlags
  stages();  // of the bindings and of the push constants: vkCmdPushConstants wants all of them

  // The set must not be in use by pending work.
  void setAccelerationStructure(VkAccelerationStructureKHR structure);
  void setTexture(std::uint32_t index, const Image& image, const Sampler& sampler);

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
