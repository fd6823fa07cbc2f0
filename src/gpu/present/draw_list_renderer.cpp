// SPDX-License-Identifier: Apache-2.0
#include "gpu/present/draw_list_renderer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

#include "gpu/upload_buffer.h"

namespace quintet::gpu {
namespace {

constexpr std::uint32_t kMaxTextures = 16;
// Sets of images that were replaced are freed when the frames that use them have ended.
constexpr std::uint32_t kMaxDrawListSets = 4 * kMaxTextures;

// As in triangles.vert: position in clip space = scale · pixels - 1.
struct DrawListConstants {
  float scale[2];
};

constexpr VkVertexInputAttributeDescription kDrawListAttributes[] = {
    {0, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(DrawVertex, x)},
    {1, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(DrawVertex, u)},
    {2, 0, VK_FORMAT_R8G8B8A8_UNORM, offsetof(DrawVertex, color)},
};

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
                         .addressV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE}),
      pipeline_(context, {.vertexShader = vertexShader,
                          .fragmentShader = fragmentShader,
                          .input = {0, sizeof(DrawVertex), VK_VERTEX_INPUT_RATE_VERTEX},
                          .attributes = kDrawListAttributes,
                          .constantBytes = sizeof(DrawListConstants),
                          .maxSets = kMaxDrawListSets,
                          .format = format,
                          .purpose = "draw the window"}) {}

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
  if (!fits || !sameFilter) {
    pipeline_.freeSet(std::exchange(texture.set, VK_NULL_HANDLE));
    texture.set = pipeline_.makeSet(texture.image, filter == VK_FILTER_LINEAR ? linear_ : nearest_);
  }
  texture.pending = std::move(pixels);
}

void DrawListRenderer::uploadTextures(Commands& commands, FrameBuffers& frame) {
  VkDeviceSize total = 0;
  for (const Texture& texture : textures_)
    if (texture.pending) total += texture.pending->size();
  if (total == 0) return;
  reserveUpload(context_, frame.staging, total, 0, "staging of the window");
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
  reserveUpload(context_, frame.vertices, vertices.size(), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, "vertices of the window");
  reserveUpload(context_, frame.indices, indices.size(), VK_BUFFER_USAGE_INDEX_BUFFER_BIT, "indices of the window");
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
  pipeline_.bind(commands, frame.vertices, target.size);
  context_.vk().vkCmdBindIndexBuffer(commands.handle(), frame.indices.handle(), 0, VK_INDEX_TYPE_UINT16);
  pipeline_.setConstants(commands, DrawListConstants{{2.0f / static_cast<float>(target.size.width),
                                                      2.0f / static_cast<float>(target.size.height)}});
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
    pipeline_.bindSet(commands, textures_[command.texture].set);
    vk.vkCmdDrawIndexed(commands.handle(), command.indexCount, 1, command.firstIndex,
                        static_cast<std::int32_t>(command.firstVertex), 0);
  }
}

}  // namespace quintet::gpu
