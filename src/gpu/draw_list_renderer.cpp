// SPDX-License-Identifier: Apache-2.0
#include "gpu/draw_list_renderer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

#include "gpu/error.h"
#include "gpu/graphics_pipeline.h"

namespace quintet::gpu {
namespace {

constexpr std::uint32_t kMaxTextures = 16;
// Sets of images that were replaced are freed when the frames that use them have ended.
constexpr std::uint32_t kMaxSets = 4 * kMaxTextures;

// As in triangles.vert: position in clip space = scale · pixels - 1.
struct PushConstants {
  float scale[2];
};

// Makes the buffer at least this large.
void grow(Context& context, Buffer& buffer, VkDeviceSize size, VkBufferUsageFlags usage, const char* name) {
  if (buffer && buffer.size() >= size) return;
  buffer = Buffer(
      context,
      {.size = size + size / 2, .memory = Memory::upload, .usage = usage, .name = name, .purpose = Purpose::staging});
}

std::int32_t toPixel(float value, std::uint32_t limit) {
  return static_cast<std::int32_t>(std::clamp(value, 0.0f, static_cast<float>(limit)));
}

}  // namespace

DrawListRenderer::DrawListRenderer(Context& context, VkFormat format, std::span<const std::uint32_t> vertexShader,
                                   std::span<const std::uint32_t> fragmentShader)
    : context_(context),
      linear_(context, {.filter = VK_FILTER_LINEAR,
                        .addressU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                        .addressV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE}),
      nearest_(context, {.filter = VK_FILTER_NEAREST,
                         .addressU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                         .addressV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE}) {
  try {
    createLayouts();
    createPipeline(format, vertexShader, fragmentShader);
  } catch (...) {
    destroy();
    throw;
  }
}

DrawListRenderer::~DrawListRenderer() { destroy(); }

void DrawListRenderer::destroy() {
  context_.retire([&context = context_, pipeline = pipeline_, layout = layout_, pool = pool_, setLayout = setLayout_] {
    const VolkDeviceTable& vk = context.vk();
    vk.vkDestroyPipeline(context.device(), pipeline, nullptr);
    vk.vkDestroyPipelineLayout(context.device(), layout, nullptr);
    vk.vkDestroyDescriptorPool(context.device(), pool, nullptr);
    vk.vkDestroyDescriptorSetLayout(context.device(), setLayout, nullptr);
  });
}

void DrawListRenderer::createLayouts() {
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

  const VkPushConstantRange constants{VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(PushConstants)};
  VkPipelineLayoutCreateInfo layoutInfo{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layoutInfo.setLayoutCount = 1;
  layoutInfo.pSetLayouts = &setLayout_;
  layoutInfo.pushConstantRangeCount = 1;
  layoutInfo.pPushConstantRanges = &constants;
  check(vk.vkCreatePipelineLayout(context_.device(), &layoutInfo, nullptr, &layout_), "create a pipeline layout");
}

void DrawListRenderer::createPipeline(VkFormat format, std::span<const std::uint32_t> vertexShader,
                                      std::span<const std::uint32_t> fragmentShader) {
  const VkVertexInputAttributeDescription attributes[] = {
      {0, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(DrawVertex, x)},
      {1, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(DrawVertex, u)},
      {2, 0, VK_FORMAT_R8G8B8A8_UNORM, offsetof(DrawVertex, color)},
  };
  pipeline_ = makeGraphicsPipeline(context_, {.vertexShader = vertexShader,
                                              .fragmentShader = fragmentShader,
                                              .input = {0, sizeof(DrawVertex), VK_VERTEX_INPUT_RATE_VERTEX},
                                              .attributes = attributes,
                                              .layout = layout_,
                                              .format = format,
                                              .purpose = "draw the window"});
}

void DrawListRenderer::setTexture(std::size_t index, VkExtent2D size,
                                  std::shared_ptr<const std::vector<std::byte>> pixels, VkFilter filter) {
  assert(index < kMaxTextures && pixels->size() == std::size_t{size.width} * size.height * 4);
  if (index >= textures_.size()) textures_.resize(index + 1);
  Texture& texture = textures_[index];
  const bool fits = texture.set && texture.image.width() == size.width && texture.image.height() == size.height;
  if (!fits) {
    texture.image = Image(context_, {.width = size.width,
                                     .height = size.height,
                                     .format = VK_FORMAT_R8G8B8A8_UNORM,
                                     .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
                                     .name = "texture of the window"});
    texture.written = false;
  }
  const bool sameFilter = std::exchange(texture.filter, filter) == filter;
  if (!fits || !sameFilter) bindImage(texture);
  texture.pending = std::move(pixels);
}

// Makes a descriptor set with image and filter. Frames in flight keep the old one.
void DrawListRenderer::bindImage(Texture& texture) {
  const VolkDeviceTable& vk = context_.vk();
  if (texture.set)
    context_.retire([&context = context_, pool = pool_, set = texture.set] {
      context.vk().vkFreeDescriptorSets(context.device(), pool, 1, &set);
    });
  texture.set = VK_NULL_HANDLE;
  VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  info.descriptorPool = pool_;
  info.descriptorSetCount = 1;
  info.pSetLayouts = &setLayout_;
  check(vk.vkAllocateDescriptorSets(context_.device(), &info, &texture.set), "allocate a descriptor set");
  VkDescriptorImageInfo image{};
  image.sampler = (texture.filter == VK_FILTER_LINEAR ? linear_ : nearest_).handle();
  image.imageView = texture.image.view();
  image.imageLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.dstSet = texture.set;
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  write.pImageInfo = &image;
  vk.vkUpdateDescriptorSets(context_.device(), 1, &write, 0, nullptr);
}

void DrawListRenderer::uploadTextures(Commands& commands, FrameBuffers& frame) {
  VkDeviceSize total = 0;
  for (const Texture& texture : textures_)
    if (texture.pending) total += texture.pending->size();
  if (total == 0) return;
  grow(context_, frame.staging, total, 0, "staging of the window");
  VkDeviceSize offset = 0;
  for (Texture& texture : textures_) {
    if (!texture.pending) continue;
    std::memcpy(frame.staging.mapped() + offset, texture.pending->data(), texture.pending->size());
    commands.transition(texture.image,
                        texture.written ? VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED,
                        VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    commands.copy(frame.staging, texture.image, offset);
    commands.transition(texture.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    offset += texture.pending->size();
    texture.written = true;
    texture.pending.reset();
  }
}

void DrawListRenderer::uploadTriangles(FrameBuffers& frame, const DrawList& list) {
  const auto vertices = std::as_bytes(std::span(list.vertices));
  const auto indices = std::as_bytes(std::span(list.indices));
  if (vertices.empty() || indices.empty()) return;
  grow(context_, frame.vertices, vertices.size(), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, "vertices of the window");
  grow(context_, frame.indices, indices.size(), VK_BUFFER_USAGE_INDEX_BUFFER_BIT, "indices of the window");
  std::memcpy(frame.vertices.mapped(), vertices.data(), vertices.size());
  std::memcpy(frame.indices.mapped(), indices.data(), indices.size());
}

void DrawListRenderer::draw(Commands& commands, const RenderTarget& target, const DrawList& list,
                            const std::array<float, 4>& background, const External& external) {
  FrameBuffers& frame = frames_[target.slot];
  uploadTextures(commands, frame);
  uploadTriangles(frame, list);
  VkRenderingAttachmentInfo attachment{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  attachment.imageView = target.view;
  attachment.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  attachment.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  std::copy(background.begin(), background.end(), attachment.clearValue.color.float32);
  VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
  info.renderArea.extent = target.size;
  info.layerCount = 1;
  info.colorAttachmentCount = 1;
  info.pColorAttachments = &attachment;
  const VolkDeviceTable& vk = context_.vk();
  vk.vkCmdBeginRendering(commands.handle(), &info);
  record(commands, target, list, frame, external);
  vk.vkCmdEndRendering(commands.handle());
}

void DrawListRenderer::bind(Commands& commands, const RenderTarget& target, const FrameBuffers& frame) {
  const VolkDeviceTable& vk = context_.vk();
  vk.vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
  const VkBuffer vertices = frame.vertices.handle();
  const VkDeviceSize offset = 0;
  vk.vkCmdBindVertexBuffers(commands.handle(), 0, 1, &vertices, &offset);
  vk.vkCmdBindIndexBuffer(commands.handle(), frame.indices.handle(), 0, VK_INDEX_TYPE_UINT16);
  const auto width = static_cast<float>(target.size.width);
  const auto height = static_cast<float>(target.size.height);
  const VkViewport viewport{0.0f, 0.0f, width, height, 0.0f, 1.0f};
  vk.vkCmdSetViewport(commands.handle(), 0, 1, &viewport);
  const PushConstants constants{{2.0f / width, 2.0f / height}};
  vk.vkCmdPushConstants(commands.handle(), layout_, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(constants), &constants);
}

void DrawListRenderer::record(Commands& commands, const RenderTarget& target, const DrawList& list,
                              const FrameBuffers& frame, const External& external) {
  const VolkDeviceTable& vk = context_.vk();
  bool bound = false;
  for (const DrawCommand& command : list.commands) {
    const VkOffset2D from{toPixel(command.left, target.size.width), toPixel(command.top, target.size.height)};
    const VkOffset2D to{toPixel(std::ceil(command.right), target.size.width),
                        toPixel(std::ceil(command.bottom), target.size.height)};
    if (to.x <= from.x || to.y <= from.y) continue;
    const VkRect2D scissor{from,
                           {static_cast<std::uint32_t>(to.x - from.x), static_cast<std::uint32_t>(to.y - from.y)}};
    if (command.external) {
      if (external) external(commands, target, scissor);
      bound = false;
      continue;
    }
    if (command.texture >= textures_.size() || !textures_[command.texture].set) continue;
    if (!bound) bind(commands, target, frame);
    bound = true;
    vk.vkCmdSetScissor(commands.handle(), 0, 1, &scissor);
    vk.vkCmdBindDescriptorSets(commands.handle(), VK_PIPELINE_BIND_POINT_GRAPHICS, layout_, 0, 1,
                               &textures_[command.texture].set, 0, nullptr);
    vk.vkCmdDrawIndexed(commands.handle(), command.indexCount, 1, command.firstIndex,
                        static_cast<std::int32_t>(command.firstVertex), 0);
  }
}

}  // namespace quintet::gpu
