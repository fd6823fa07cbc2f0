// SPDX-License-Identifier: Apache-2.0
#include "gpu/line_renderer.h"

#include <cassert>
#include <cstddef>
#include <cstring>
#include <limits>
#include <utility>

#include "gpu/error.h"
#include "gpu/graphics_pipeline.h"

namespace quintet::gpu {
namespace {

// Sets of depth images that were replaced are freed when the frames that use them have ended.
constexpr std::uint32_t kMaxSets = 16;
constexpr std::uint32_t kVerticesPerLine = 6;

// As in lines.vert and lines.frag.
struct PushConstants {
  float scale[2];        // 2 / size of the target
  float depthOrigin[2];  // pixels
  float depthScale;
  float relativeBias, bias;
  float hiddenOpacity;
  float dash;
  std::uint32_t outline;  // 1: the outlines are drawn
};

// Makes the buffer at least this large.
void grow(Context& context, Buffer& buffer, VkDeviceSize size, VkBufferUsageFlags usage, const char* name) {
  if (buffer && buffer.size() >= size) return;
  buffer = Buffer(
      context,
      {.size = size + size / 2, .memory = Memory::upload, .usage = usage, .name = name, .purpose = Purpose::staging});
}

}  // namespace

LineRenderer::LineRenderer(Context& context, VkFormat format, std::span<const std::uint32_t> vertexShader,
                           std::span<const std::uint32_t> fragmentShader)
    : context_(context),
      sampler_(context, {.filter = VK_FILTER_NEAREST,
                         .addressU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                         .addressV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE}) {
  requireGraphicsQueue(context);
  try {
    createLayouts();
    createPipeline(format, vertexShader, fragmentShader);
    setDepth({}, nullptr);
  } catch (...) {
    destroy();
    throw;
  }
}

LineRenderer::~LineRenderer() { destroy(); }

void LineRenderer::destroy() {
  context_.retire([&context = context_, pipeline = pipeline_, layout = layout_, pool = pool_, setLayout = setLayout_] {
    const VolkDeviceTable& vk = context.vk();
    vk.vkDestroyPipeline(context.device(), pipeline, nullptr);
    vk.vkDestroyPipelineLayout(context.device(), layout, nullptr);
    vk.vkDestroyDescriptorPool(context.device(), pool, nullptr);
    vk.vkDestroyDescriptorSetLayout(context.device(), setLayout, nullptr);
  });
}

void LineRenderer::createLayouts() {
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

  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, kMaxSets};
  VkDescriptorPoolCreateInfo poolInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  poolInfo.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
  poolInfo.maxSets = kMaxSets;
  poolInfo.poolSizeCount = 1;
  poolInfo.pPoolSizes = &size;
  check(vk.vkCreateDescriptorPool(context_.device(), &poolInfo, nullptr, &pool_), "create a descriptor pool");

  const VkPushConstantRange constants{VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                                      sizeof(PushConstants)};
  VkPipelineLayoutCreateInfo layoutInfo{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layoutInfo.setLayoutCount = 1;
  layoutInfo.pSetLayouts = &setLayout_;
  layoutInfo.pushConstantRangeCount = 1;
  layoutInfo.pPushConstantRanges = &constants;
  check(vk.vkCreatePipelineLayout(context_.device(), &layoutInfo, nullptr, &layout_), "create a pipeline layout");
}

void LineRenderer::createPipeline(VkFormat format, std::span<const std::uint32_t> vertexShader,
                                  std::span<const std::uint32_t> fragmentShader) {
  const VkVertexInputAttributeDescription attributes[] = {
      {0, 0, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(Line, ax)},
      {1, 0, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(Line, depthA)},
      {2, 0, VK_FORMAT_R8G8B8A8_UNORM, offsetof(Line, color)},
      {3, 0, VK_FORMAT_R8G8B8A8_UNORM, offsetof(Line, outlineColor)},
      {4, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(Line, width)},
  };
  pipeline_ = makeGraphicsPipeline(context_, {.vertexShader = vertexShader,
                                              .fragmentShader = fragmentShader,
                                              .input = {0, sizeof(Line), VK_VERTEX_INPUT_RATE_INSTANCE},
                                              .attributes = attributes,
                                              .layout = layout_,
                                              .format = format,
                                              .purpose = "draw lines"});
}

void LineRenderer::setDepth(VkExtent2D size, std::shared_ptr<const std::vector<float>> depths) {
  if (!depths) {
    size = {1, 1};
    depths = std::make_shared<const std::vector<float>>(1, std::numeric_limits<float>::lowest());
  }
  assert(depths->size() == std::size_t{size.width} * size.height);
  if (!set_ || depth_.width() != size.width || depth_.height() != size.height) {
    depth_ = Image(context_, {.width = size.width,
                              .height = size.height,
                              .format = VK_FORMAT_R32_SFLOAT,
                              .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
                              .name = "depth of the surfaces"});
    depthWritten_ = false;
    bindDepth();
  }
  pendingDepths_ = std::move(depths);
}

// Makes a descriptor set with the image. Frames in flight keep the old one.
void LineRenderer::bindDepth() {
  const VolkDeviceTable& vk = context_.vk();
  if (set_)
    context_.retire([&context = context_, pool = pool_, set = set_] {
      context.vk().vkFreeDescriptorSets(context.device(), pool, 1, &set);
    });
  set_ = VK_NULL_HANDLE;
  VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  info.descriptorPool = pool_;
  info.descriptorSetCount = 1;
  info.pSetLayouts = &setLayout_;
  check(vk.vkAllocateDescriptorSets(context_.device(), &info, &set_), "allocate a descriptor set");
  const VkDescriptorImageInfo image{sampler_.handle(), depth_.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.dstSet = set_;
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  write.pImageInfo = &image;
  vk.vkUpdateDescriptorSets(context_.device(), 1, &write, 0, nullptr);
}

void LineRenderer::uploadDepth(Commands& commands, std::uint32_t slot) {
  if (!pendingDepths_) return;
  const auto bytes = std::as_bytes(std::span(*pendingDepths_));
  grow(context_, staging_[slot], bytes.size(), 0, "staging of depths");
  std::memcpy(staging_[slot].mapped(), bytes.data(), bytes.size());
  commands.transition(depth_, depthWritten_ ? VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED,
                      VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  commands.copy(staging_[slot], depth_);
  commands.transition(depth_, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  depthWritten_ = true;
  pendingDepths_.reset();
}

void LineRenderer::prepare(Commands& commands, std::uint32_t slot, const LineList& list) {
  uploadDepth(commands, slot);
  const auto bytes = std::as_bytes(std::span(list.lines));
  if (!bytes.empty()) {
    grow(context_, lineBuffers_[slot], bytes.size(), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, "lines");
    std::memcpy(lineBuffers_[slot].mapped(), bytes.data(), bytes.size());
  }
  preparedCount_ = static_cast<std::uint32_t>(list.lines.size());
  preparedSlot_ = slot;
  prepared_ = {{},        list.depthX,        list.depthY, list.depthScale, list.relativeBias,
               list.bias, list.hiddenOpacity, list.dash};
}

void LineRenderer::record(Commands& commands, const RenderTarget& target, const VkRect2D& rectangle) {
  if (preparedCount_ == 0) return;
  const VolkDeviceTable& vk = context_.vk();
  vk.vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
  const VkBuffer lines = lineBuffers_[preparedSlot_].handle();
  const VkDeviceSize offset = 0;
  vk.vkCmdBindVertexBuffers(commands.handle(), 0, 1, &lines, &offset);
  vk.vkCmdBindDescriptorSets(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, layout_, 0, 1, &set_, 0, nullptr);
  const auto width = static_cast<float>(target.size.width);
  const auto height = static_cast<float>(target.size.height);
  const VkViewport viewport{0.0f, 0.0f, width, height, 0.0f, 1.0f};
  vk.vkCmdSetViewport(commands.handle(), 0, 1, &viewport);
  vk.vkCmdSetScissor(commands.handle(), 0, 1, &rectangle);
  PushConstants constants{{2.0f / width, 2.0f / height},
                          {prepared_.depthX, prepared_.depthY},
                          prepared_.depthScale,
                          prepared_.relativeBias,
                          prepared_.bias,
                          prepared_.hiddenOpacity,
                          prepared_.dash,
                          1};
  for (const std::uint32_t outline : {1u, 0u}) {
    constants.outline = outline;
    vk.vkCmdPushConstants(commands.handle(), layout_, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                          sizeof(constants), &constants);
    vk.vkCmdDraw(commands.handle(), kVerticesPerLine, preparedCount_, 0, 0);
  }
}

}  // namespace quintet::gpu
