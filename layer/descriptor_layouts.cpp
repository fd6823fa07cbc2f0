// SPDX-License-Identifier: Apache-2.0
#include "descriptor_layouts.h"

#include <algorithm>
#include <utility>

#include "chains.h"

namespace quintet::layer {

void DescriptorLayouts::addSetLayout(VkDescriptorSetLayout layout, const VkDescriptorSetLayoutCreateInfo& info) {
  const auto* flags = findInChain<VkDescriptorSetLayoutBindingFlagsCreateInfo>(
      info.pNext, VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_BINDING_FLAGS_CREATE_INFO);
  SetLayout added;
  for (std::uint32_t i = 0; i < info.bindingCount; ++i) {
    const VkDescriptorSetLayoutBinding& binding = info.pBindings[i];
    // The count of an inline uniform block is its size in bytes.
    if (binding.descriptorType == VK_DESCRIPTOR_TYPE_INLINE_UNIFORM_BLOCK) continue;
    added.counts[binding.binding] = binding.descriptorCount;
    if (flags && i < flags->bindingCount &&
        (flags->pBindingFlags[i] & VK_DESCRIPTOR_BINDING_VARIABLE_DESCRIPTOR_COUNT_BIT) != 0)
      added.variable = binding.binding;
  }
  const std::scoped_lock lock(mutex_);
  setLayouts_[layout] = std::move(added);
}

void DescriptorLayouts::removeSetLayout(VkDescriptorSetLayout layout) {
  const std::scoped_lock lock(mutex_);
  setLayouts_.erase(layout);
}

void DescriptorLayouts::addPipelineLayout(VkPipelineLayout layout, const VkPipelineLayoutCreateInfo& info) {
  const std::scoped_lock lock(mutex_);
  DescriptorCounts counts;
  for (std::uint32_t set = 0; set < info.setLayoutCount; ++set) {
    const auto found = setLayouts_.find(info.pSetLayouts[set]);
    if (found == setLayouts_.end()) continue;
    for (const auto& [binding, count] : found->second.counts) counts[{set, binding}] = count;
  }
  pipelineLayouts_[layout] = std::move(counts);
}

void DescriptorLayouts::removePipelineLayout(VkPipelineLayout layout) {
  const std::scoped_lock lock(mutex_);
  pipelineLayouts_.erase(layout);
}

DescriptorCounts DescriptorLayouts::countsOf(VkPipelineLayout layout) {
  const std::scoped_lock lock(mutex_);
  const auto found = pipelineLayouts_.find(layout);
  return found == pipelineLayouts_.end() ? DescriptorCounts{} : found->second;
}

void DescriptorLayouts::addSets(const VkDescriptorSetAllocateInfo& info, const VkDescriptorSet* sets) {
  const auto* variable = findInChain<VkDescriptorSetVariableDescriptorCountAllocateInfo>(
      info.pNext, VK_STRUCTURE_TYPE_DESCRIPTOR_SET_VARIABLE_DESCRIPTOR_COUNT_ALLOCATE_INFO);
  const std::scoped_lock lock(mutex_);
  for (std::uint32_t i = 0; i < info.descriptorSetCount; ++i) {
    sets_.erase(sets[i]);
    const auto layout = setLayouts_.find(info.pSetLayouts[i]);
    if (layout == setLayouts_.end() || !layout->second.variable) continue;
    const std::uint32_t count = variable && i < variable->descriptorSetCount ? variable->pDescriptorCounts[i] : 0;
    sets_[sets[i]] = {info.descriptorPool, *layout->second.variable, count};
  }
}

void DescriptorLayouts::removeSets(std::uint32_t count, const VkDescriptorSet* sets) {
  const std::scoped_lock lock(mutex_);
  for (std::uint32_t i = 0; i < count; ++i) sets_.erase(sets[i]);
}

void DescriptorLayouts::removePool(VkDescriptorPool pool) {
  const std::scoped_lock lock(mutex_);
  std::erase_if(sets_, [&](const auto& entry) { return entry.second.pool == pool; });
}

void DescriptorLayouts::bind(VkCommandBuffer commands, std::uint32_t first, std::uint32_t count,
                             const VkDescriptorSet* sets) {
  const std::scoped_lock lock(mutex_);
  std::map<std::uint32_t, VariableCount>& bound = bound_[commands];
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto found = sets_.find(sets[i]);
    if (found == sets_.end())
      bound.erase(first + i);
    else
      bound[first + i] = found->second;
  }
}

void DescriptorLayouts::forget(VkCommandBuffer commands) {
  const std::scoped_lock lock(mutex_);
  bound_.erase(commands);
}

DescriptorCounts DescriptorLayouts::withBoundSets(DescriptorCounts counts, VkCommandBuffer commands) {
  const std::scoped_lock lock(mutex_);
  const auto bound = bound_.find(commands);
  if (bound == bound_.end()) return counts;
  for (const auto& [set, variable] : bound->second) {
    const auto found = counts.find({set, variable.binding});
    if (found != counts.end()) found->second = std::min(found->second, variable.count);
  }
  return counts;
}

}  // namespace quintet::layer
