// SPDX-License-Identifier: Apache-2.0
#include "gpu/present/graphics_pipeline.h"

#include "gpu/error.h"

namespace quintet::gpu {
namespace {

constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

VkShaderModule makeModule(Context& context, std::span<const std::uint32_t> spirv) {
  VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  info.codeSize = spirv.size_bytes();
  info.pCode = spirv.data();
  VkShaderModule shader = VK_NULL_HANDLE;
  check(context.vk().vkCreateShaderModule(context.device(), &info, nullptr, &shader), "load a graphics shader");
  return shader;
}

VkPipelineShaderStageCreateInfo stageInfo(VkShaderStageFlagBits stage, VkShaderModule shader) {
  VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  info.stage = stage;
  info.module = shader;
  info.pName = "main";
  return info;
}

VkPipelineColorBlendAttachmentState alphaBlending() {
  VkPipelineColorBlendAttachmentState blend{};
  blend.blendEnable = VK_TRUE;
  blend.srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
  blend.dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  blend.colorBlendOp = VK_BLEND_OP_ADD;
  blend.srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
  blend.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  blend.alphaBlendOp = VK_BLEND_OP_ADD;
  blend.colorWriteMask =
      VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
  return blend;
}

VkPipeline createPipeline(Context& context, const GraphicsPipelineOptions& options, VkPipelineLayout layout,
                          VkShaderModule vertex, VkShaderModule fragment) {
  VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  input.vertexBindingDescriptionCount = 1;
  input.pVertexBindingDescriptions = &options.input;
  input.vertexAttributeDescriptionCount = static_cast<std::uint32_t>(options.attributes.size());
  input.pVertexAttributeDescriptions = options.attributes.data();
  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = 1;
  viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.polygonMode = VK_POLYGON_MODE_FILL;
  raster.cullMode = VK_CULL_MODE_NONE;
  raster.lineWidth = 1.0f;
  VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  const VkPipelineColorBlendAttachmentState blend = alphaBlending();
  VkPipelineColorBlendStateCreateInfo blending{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blending.attachmentCount = 1;
  blending.pAttachments = &blend;
  const VkDynamicState dynamicStates[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  dynamic.dynamicStateCount = 2;
  dynamic.pDynamicStates = dynamicStates;
  VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
  rendering.colorAttachmentCount = 1;
  rendering.pColorAttachmentFormats = &options.format;

  const VkPipelineShaderStageCreateInfo stages[] = {stageInfo(VK_SHADER_STAGE_VERTEX_BIT, vertex),
                                                    stageInfo(VK_SHADER_STAGE_FRAGMENT_BIT, fragment)};
  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
  info.pNext = &rendering;
  info.stageCount = 2;
  info.pStages = stages;
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pColorBlendState = &blending;
  info.pDynamicState = &dynamic;
  info.layout = layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(context.vk().vkCreateGraphicsPipelines(context.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
        "create a pipeline to", options.purpose);
  return pipeline;
}

VkPipeline createPipeline(Context& context, const GraphicsPipelineOptions& options, VkPipelineLayout layout) {
  // Destroys the shaders, which the pipeline does not need.
  struct Modules {
    Context& context;
    VkShaderModule vertex = VK_NULL_HANDLE, fragment = VK_NULL_HANDLE;
    ~Modules() {
      context.vk().vkDestroyShaderModule(context.device(), vertex, nullptr);
      context.vk().vkDestroyShaderModule(context.device(), fragment, nullptr);
    }
  } modules{context};
  modules.vertex = makeModule(context, options.vertexShader);
  modules.fragment = makeModule(context, options.fragmentShader);
  return createPipeline(context, options, layout, modules.vertex, modules.fragment);
}

}  // namespace

GraphicsPipeline::GraphicsPipeline(Context& context, const GraphicsPipelineOptions& options) : context_(context) {
  try {
    createLayouts(options);
    pipeline_ = createPipeline(context, options, layout_);
  } catch (...) {
    destroy();
    throw;
  }
}

GraphicsPipeline::~GraphicsPipeline() { destroy(); }

void GraphicsPipeline::destroy() {
  context_.retire([&context = context_, pipeline = pipeline_, layout = layout_, pool = pool_, setLayout = setLayout_] {
    const VolkDeviceTable& vk = context.vk();
    vk.vkDestroyPipeline(context.device(), pipeline, nullptr);
    vk.vkDestroyPipelineLayout(context.device(), layout, nullptr);
    vk.vkDestroyDescriptorPool(context.device(), pool, nullptr);
    vk.vkDestroyDescriptorSetLayout(context.device(), setLayout, nullptr);
  });
}

void GraphicsPipeline::createLayouts(const GraphicsPipelineOptions& options) {
  const VolkDeviceTable& vk = context_.vk();
  VkDescriptorSetLayoutBinding binding{};
  binding.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  binding.descriptorCount = 1;
  binding.stageFlags = VK_SHADER_STAGE_FRAGMENT_BIT;
  VkDescriptorSetLayoutCreateInfo setInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  setInfo.bindingCount = 1;
  setInfo.pBindings = &binding;
  check(vk.vkCreateDescriptorSetLayout(context_.device(), &setInfo, nullptr, &setLayout_),
        "create a descriptor layout");

  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, options.maxSets};
  VkDescriptorPoolCreateInfo poolInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  poolInfo.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
  poolInfo.maxSets = options.maxSets;
  poolInfo.poolSizeCount = 1;
  poolInfo.pPoolSizes = &size;
  check(vk.vkCreateDescriptorPool(context_.device(), &poolInfo, nullptr, &pool_), "create a descriptor pool");

  const VkPushConstantRange constants{kStages, 0, options.constantBytes};
  VkPipelineLayoutCreateInfo layoutInfo{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layoutInfo.setLayoutCount = 1;
  layoutInfo.pSetLayouts = &setLayout_;
  layoutInfo.pushConstantRangeCount = 1;
  layoutInfo.pPushConstantRanges = &constants;
  check(vk.vkCreatePipelineLayout(context_.device(), &layoutInfo, nullptr, &layout_), "create a pipeline layout");
}

VkDescriptorSet GraphicsPipeline::makeSet(const Image& image, const Sampler& sampler) {
  const VolkDeviceTable& vk = context_.vk();
  VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  info.descriptorPool = pool_;
  info.descriptorSetCount = 1;
  info.pSetLayouts = &setLayout_;
  VkDescriptorSet set = VK_NULL_HANDLE;
  check(vk.vkAllocateDescriptorSets(context_.device(), &info, &set), "allocate a descriptor set");
  const VkDescriptorImageInfo descriptor{sampler.handle(), image.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.dstSet = set;
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  write.pImageInfo = &descriptor;
  vk.vkUpdateDescriptorSets(context_.device(), 1, &write, 0, nullptr);
  return set;
}

void GraphicsPipeline::freeSet(VkDescriptorSet set) {
  if (!set) return;
  context_.retire(
      [&context = context_, pool = pool_, set] { context.vk().vkFreeDescriptorSets(context.device(), pool, 1, &set); });
}

void GraphicsPipeline::bind(Commands& commands, const Buffer& vertices, VkExtent2D target) const {
  const VolkDeviceTable& vk = context_.vk();
  vk.vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
  const VkBuffer buffer = vertices.handle();
  const VkDeviceSize offset = 0;
  vk.vkCmdBindVertexBuffers(commands.handle(), 0, 1, &buffer, &offset);
  const VkViewport viewport{0.0f, 0.0f, static_cast<float>(target.width), static_cast<float>(target.height),
                            0.0f, 1.0f};
  vk.vkCmdSetViewport(commands.handle(), 0, 1, &viewport);
}

void GraphicsPipeline::bindSet(Commands& commands, VkDescriptorSet set) const {
  context_.vk().vkCmdBindDescriptorSets(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, layout_, 0, 1, &set, 0,
                                        nullptr);
}

void GraphicsPipeline::setConstants(Commands& commands, std::span<const std::byte> bytes) const {
  context_.vk().vkCmdPushConstants(commands.handle(), layout_, kStages, 0, static_cast<std::uint32_t>(bytes.size()),
                                   bytes.data());
}

}  // namespace quintet::gpu
