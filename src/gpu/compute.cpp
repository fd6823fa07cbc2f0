// SPDX-License-Identifier: Apache-2.0
#include "gpu/compute.h"

#include <cassert>

#include "gpu/error.h"
#include "gpu/pipeline_store.h"

namespace quintet::gpu {
namespace {

VkPipeline make(Context& context, const BindlessSet& set, std::span<const std::uint32_t> spirv, VkPipelineCache cache,
                const std::string& name) {
  VkShaderModuleCreateInfo moduleInfo{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  moduleInfo.codeSize = spirv.size_bytes();
  moduleInfo.pCode = spirv.data();
  VkShaderModule shader = VK_NULL_HANDLE;
  check(context.vk().vkCreateShaderModule(context.device(), &moduleInfo, nullptr, &shader), "load compute shader",
        name);

  VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = shader;
  info.stage.pName = "main";
  info.layout = set.pipelineLayout();
  VkPipeline pipeline = VK_NULL_HANDLE;
  const VkResult result = context.vk().vkCreateComputePipelines(context.device(), cache, 1, &info, nullptr, &pipeline);
  context.vk().vkDestroyShaderModule(context.device(), shader, nullptr);
  check(result, "create compute pipeline", name);
  context.setName(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline), name);
  return pipeline;
}

}  // namespace

ComputePipeline::ComputePipeline(Context& context, const BindlessSet& set, std::span<const std::uint32_t> spirv,
                                 VkPipelineCache cache, const std::string& name)
    : context_(context), set_(set), stored_(cache == VK_NULL_HANDLE) {
  const auto makeIt = [&] { return make(context, set, spirv, cache, name); };
  if (stored_) key_ = Hasher().add("compute").add(set.pushConstantBytes()).add(std::as_bytes(spirv)).finish();
  pipeline_ = stored_ ? context.pipelines().acquire(key_, makeIt) : makeIt();
}

ComputePipeline::~ComputePipeline() {
  if (stored_)
    context_.pipelines().release(key_);
  else
    context_.retire([&context = context_, pipeline = pipeline_] {
      context.vk().vkDestroyPipeline(context.device(), pipeline, nullptr);
    });
}

void ComputePipeline::dispatch(Commands& commands, std::span<const std::byte> constants, std::uint32_t groupsX,
                               std::uint32_t groupsY, std::uint32_t groupsZ) const {
  assert(constants.size() <= set_.pushConstantBytes());
  const VolkDeviceTable& vk = context_.vk();
  const VkDescriptorSet set = set_.set();
  vk.vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
  vk.vkCmdBindDescriptorSets(commands.handle(), VK_PIPELINE_BIND_POINT_COMPUTE, set_.pipelineLayout(), 0, 1, &set, 0,
                             nullptr);
  if (!constants.empty())
    vk.vkCmdPushConstants(commands.handle(), set_.pipelineLayout(), BindlessSet::stages(), 0,
                          static_cast<std::uint32_t>(constants.size()), constants.data());
  vk.vkCmdDispatch(commands.handle(), groupsX, groupsY, groupsZ);
}

}  // namespace quintet::gpu
