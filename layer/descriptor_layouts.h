// SPDX-License-Identifier: Apache-2.0
// The lengths of descriptor arrays: those of the layouts of pipelines, and the smaller ones of sets with a variable count that are
// bound to a command buffer. What a descriptor refers to is not followed. Thread-safe.
#ifndef QUINTET_LAYER_DESCRIPTOR_LAYOUTS_H
#define QUINTET_LAYER_DESCRIPTOR_LAYOUTS_H

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include <vulkan/vulkan.h>

#include "check/pipeline_groups.h"

namespace quintet::layer {

using check::DescriptorCounts;

// VkBindDescriptorSetsInfo of VK_KHR_maintenance6, which the headers of Vulkan 1.3.239 do not have.
struct BindDescriptorSetsInfo {
  VkStructureType sType;
  const void* pNext;
  VkShaderStageFlags stageFlags;
  VkPipelineLayout layout;
  std::uint32_t firstSet;
  std::uint32_t descriptorSetCount;
  const VkDescriptorSet* pDescriptorSets;
  std::uint32_t dynamicOffsetCount;
  const std::uint32_t* pDynamicOffsets;
};

class DescriptorLayouts {
 public:
  void addSetLayout(VkDescriptorSetLayout layout, const VkDescriptorSetLayoutCreateInfo& info);
  void removeSetLayout(VkDescriptorSetLayout layout);
  // A pipeline layout keeps what it needs of its set layouts.
  void addPipelineLayout(VkPipelineLayout layout, const VkPipelineLayoutCreateInfo& info);
  void removePipelineLayout(VkPipelineLayout layout);
  DescriptorCounts countsOf(VkPipelineLayout layout);  // empty if unknown

  // Only with sbt=1: sets, and which ones the next trace of a command buffer uses.
  void addSets(const VkDescriptorSetAllocateInfo& info, const VkDescriptorSet* sets);
  void removeSets(std::uint32_t count, const VkDescriptorSet* sets);
  void removePool(VkDescriptorPool pool);  // its sets: it is reset or destroyed
  void bind(VkCommandBuffer commands, std::uint32_t first, std::uint32_t count, const VkDescriptorSet* sets);
  void forget(VkCommandBuffer commands);
  // `counts` of a pipeline layout, with the counts of the bound sets where these are smaller.
  DescriptorCounts withBoundSets(DescriptorCounts counts, VkCommandBuffer commands);

 private:
  struct SetLayout {
    std::map<std::uint32_t, std::uint32_t> counts;  // by binding
    std::optional<std::uint32_t> variable;          // the binding whose count each set has
  };
  struct VariableCount {
    VkDescriptorPool pool = VK_NULL_HANDLE;
    std::uint32_t binding = 0, count = 0;
  };

  std::mutex mutex_;
  std::unordered_map<VkDescriptorSetLayout, SetLayout> setLayouts_;
  std::unordered_map<VkPipelineLayout, DescriptorCounts> pipelineLayouts_;
  std::unordered_map<VkDescriptorSet, VariableCount> sets_;                            // that have a variable count
  std::unordered_map<VkCommandBuffer, std::map<std::uint32_t, VariableCount>> bound_;  // by number of the set
};

}  // namespace quintet::layer
#endif
