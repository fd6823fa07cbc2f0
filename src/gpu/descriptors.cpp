// SPDX-License-Identifier: Apache-2.0
#include "gpu/descriptors.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include <fmt/format.h>

#include "gpu/error.h"
#include "quintet/shared/bindings.h"

namespace quintet::gpu {
namespace {

// Textures of the layout. A set has the number that it was created with. Because all layouts are equal, a pipeline can
// be used with scenes of any number of textures.
constexpr std::uint32_t kLayoutTextures = 16384;

constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_RAYGEN_BIT_KHR | VK_SHADER_STAGE_ANY_HIT_BIT_KHR |
                                       VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR | VK_SHADER_STAGE_MISS_BIT_KHR |
                                       VK_SHADER_STAGE_INTERSECTION_BIT_KHR | VK_SHADER_STAGE_CALLABLE_BIT_KHR |
                                       VK_SHADER_STAGE_COMPUTE_BIT;

VkDescriptorType descriptorType(shared::BindingType type) {
  return type == shared::BindingType::accelerationStructure ? VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR
                                                            : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
}

VkDescriptorSetLayout createLayout(Context& context, std::uint32_t textures) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  std::vector<VkDescriptorBindingFlags> flags;
  for (const shared::Binding& binding : shared::kBindings) {
    const bool array = binding.type == shared::BindingType::textures;
    bindings.push_back({binding.number, descriptorType(binding.type), array ? textures : 1, kStages, nullptr});
    flags.push_back(VK_DESCRIPTOR_BINDING_PARTIALLY_BOUND_BIT);
    if (array) flags.back() |= VK_DESCRIPTOR_BINDING_VARIABLE_DESCRIPTOR_COUNT_BIT;  // it is the last binding
  }
  VkDescriptorSetLayoutBindingFlagsCreateInfo flagsInfo{
      VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_BINDING_FLAGS_CREATE_INFO};
  flagsInfo.bindingCount = static_cast<std::uint32_t>(flags.size());
  flagsInfo.pBindingFlags = flags.data();
  VkDescriptorSetLayoutCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  info.pNext = &flagsInfo;
  info.bindingCount = static_cast<std::uint32_t>(bindings.size());
  info.pBindings = bindings.data();
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  check(context.vk().vkCreateDescriptorSetLayout(context.device(), &info, nullptr, &layout),
        "create the descriptor set layout");
  return layout;
}

VkPipelineLayout createPipelineLayout(Context& context, VkDescriptorSetLayout set, std::uint32_t pushConstantBytes) {
  const VkPushConstantRange range{kStages, 0, pushConstantBytes};
  VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  info.setLayoutCount = 1;
  info.pSetLayouts = &set;
  info.pushConstantRangeCount = pushConstantBytes > 0 ? 1 : 0;
  info.pPushConstantRanges = &range;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  check(context.vk().vkCreatePipelineLayout(context.device(), &info, nullptr, &layout), "create the pipeline layout");
  return layout;
}

VkDescriptorPool createPool(Context& context, std::uint32_t textures) {
  std::vector<VkDescriptorPoolSize> sizes;
  for (const shared::Binding& binding : shared::kBindings)
    sizes.push_back({descriptorType(binding.type), binding.type == shared::BindingType::textures ? textures : 1});
  VkDescriptorPoolCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  info.maxSets = 1;
  info.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
  info.pPoolSizes = sizes.data();
  VkDescriptorPool pool = VK_NULL_HANDLE;
  check(context.vk().vkCreateDescriptorPool(context.device(), &info, nullptr, &pool), "create the descriptor pool");
  return pool;
}

VkDescriptorSet allocateSet(Context& context, VkDescriptorPool pool, VkDescriptorSetLayout layout,
                            std::uint32_t textures) {
  VkDescriptorSetVariableDescriptorCountAllocateInfo variable{
      VK_STRUCTURE_TYPE_DESCRIPTOR_SET_VARIABLE_DESCRIPTOR_COUNT_ALLOCATE_INFO};
  variable.descriptorSetCount = 1;
  variable.pDescriptorCounts = &textures;
  VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  info.pNext = &variable;
  info.descriptorPool = pool;
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  check(context.vk().vkAllocateDescriptorSets(context.device(), &info, &set), "allocate the descriptor set");
  return set;
}

}  // namespace

BindlessSet::BindlessSet(Context& context, std::uint32_t textureCount, std::uint32_t pushConstantBytes)
    : context_(context), textureCount_(std::max(textureCount, 1u)), pushConstantBytes_(pushConstantBytes) {
  const std::uint32_t capacity = std::min(kLayoutTextures, context.info().maxTextures);
  if (textureCount_ > capacity)
    throw MemoryError(fmt::format("{} textures are too many for this device; at most {}", textureCount_, capacity));
  try {
    layout_ = createLayout(context, capacity);
    pipelineLayout_ = createPipelineLayout(context, layout_, pushConstantBytes);
    pool_ = createPool(context, textureCount_);
    set_ = allocateSet(context, pool_, layout_, textureCount_);
  } catch (...) {
    release();
    throw;
  }
}

BindlessSet::~BindlessSet() { release(); }

VkShaderStageFlags BindlessSet::stages() { return kStages; }

void BindlessSet::release() {
  context_.retire([&context = context_, pool = pool_, pipelineLayout = pipelineLayout_, layout = layout_] {
    context.vk().vkDestroyDescriptorPool(context.device(), pool, nullptr);
    context.vk().vkDestroyPipelineLayout(context.device(), pipelineLayout, nullptr);
    context.vk().vkDestroyDescriptorSetLayout(context.device(), layout, nullptr);
  });
}

void BindlessSet::setAccelerationStructure(VkAccelerationStructureKHR structure) {
  VkWriteDescriptorSetAccelerationStructureKHR structures{
      VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR};
  structures.accelerationStructureCount = 1;
  structures.pAccelerationStructures = &structure;
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.pNext = &structures;
  write.dstSet = set_;
  write.dstBinding = shared::kBindingTlas;
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR;
  context_.vk().vkUpdateDescriptorSets(context_.device(), 1, &write, 0, nullptr);
}

void BindlessSet::setTexture(std::uint32_t index, const Image& image, const Sampler& sampler) {
  assert(index < textureCount_);
  const VkDescriptorImageInfo texture{sampler.handle(), image.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.dstSet = set_;
  write.dstBinding = shared::kBindingTextures;
  write.dstArrayElement = index;
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  write.pImageInfo = &texture;
  context_.vk().vkUpdateDescriptorSets(context_.device(), 1, &write, 0, nullptr);
}

}  // namespace quintet::gpu
