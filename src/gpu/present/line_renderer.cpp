// SPDX-License-Identifier: Apache-2.0
#include "gpu/present/line_renderer.h"

#include <cassert>
#include <cstddef>
#include <cstring>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "gpu/device_query.h"
#include "gpu/upload_buffer.h"

namespace quintet::gpu {
namespace {

// Sets of depth images that were replaced are freed when the frames that use them have ended.
constexpr std::uint32_t kMaxLineSets = 16;
constexpr std::uint32_t kVerticesPerLine = 6;

// As in lines.vert and lines.frag.
struct LineConstants {
  float scale[2];        // 2 / size of the target
  float depthOrigin[2];  // pixels
  float depthScale;
  float relativeBias, bias;
  float hiddenOpacity;
  float dash;
  std::uint32_t outline;  // 1: the outlines are drawn
};

constexpr VkVertexInputAttributeDescription kLineAttributes[] = {
    {0, 0, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(Line, ax)},
    {1, 0, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(Line, depthA)},
    {2, 0, VK_FORMAT_R8G8B8A8_UNORM, offsetof(Line, color)},
    {3, 0, VK_FORMAT_R8G8B8A8_UNORM, offsetof(Line, outlineColor)},
    {4, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(Line, width)},
};

}  // namespace

Context& requireGraphicsQueue(Context& context) {
  const std::vector<VkQueueFamilyProperties> families = queueFamilies(context.physicalDevice());
  if (families.at(context.queueFamily()).queueFlags & VK_QUEUE_GRAPHICS_BIT) return context;
  throw Error(fmt::format("device '{}' has no graphics queue, so it cannot draw lines; use a different device",
                          context.info().name));
}

LineRenderer::LineRenderer(Context& context, VkFormat format, std::span<const std::uint32_t> vertexShader,
                           std::span<const std::uint32_t> fragmentShader)
    : context_(requireGraphicsQueue(context)),
      sampler_(context, {.filter = VK_FILTER_NEAREST,
                         .addressU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                         .addressV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE}),
      pipeline_(context, {.vertexShader = vertexShader,
                          .fragmentShader = fragmentShader,
                          .input = {0, sizeof(Line), VK_VERTEX_INPUT_RATE_INSTANCE},
                          .attributes = kLineAttributes,
                          .constantBytes = sizeof(LineConstants),
                          .maxSets = kMaxLineSets,
                          .format = format,
                          .purpose = "draw lines"}) {
  setDepth({}, nullptr);
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
    pipeline_.freeSet(std::exchange(set_, VK_NULL_HANDLE));
    set_ = pipeline_.makeSet(depth_, sampler_);
  }
  pendingDepths_ = std::move(depths);
}

void LineRenderer::uploadDepth(Commands& commands, std::uint32_t slot) {
  if (!pendingDepths_) return;
  const auto bytes = std::as_bytes(std::span(*pendingDepths_));
  reserveUpload(context_, staging_[slot], bytes.size(), 0, "staging of depths");
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
    reserveUpload(context_, lineBuffers_[slot], bytes.size(), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, "lines");
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
  pipeline_.bind(commands, lineBuffers_[preparedSlot_], target.size);
  pipeline_.bindSet(commands, set_);
  const auto width = static_cast<float>(target.size.width);
  const auto height = static_cast<float>(target.size.height);
  vk.vkCmdSetScissor(commands.handle(), 0, 1, &rectangle);
  LineConstants constants{{2.0f / width, 2.0f / height},
                          {prepared_.depthX, prepared_.depthY},
                          prepared_.depthScale,
                          prepared_.relativeBias,
                          prepared_.bias,
                          prepared_.hiddenOpacity,
                          prepared_.dash,
                          1};
  for (const std::uint32_t outline : {1u, 0u}) {
    constants.outline = outline;
    pipeline_.setConstants(commands, constants);
    vk.vkCmdDraw(commands.handle(), kVerticesPerLine, preparedCount_, 0, 0);
  }
}

void LineRenderer::draw(Commands& commands, const Image& target, const LineList& list, VkAttachmentLoadOp load) {
  const VkExtent2D size{target.width(), target.height()};
  VkRenderingAttachmentInfo attachment{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  attachment.imageView = target.view();
  attachment.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  attachment.loadOp = load;
  attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
  info.renderArea.extent = size;
  info.layerCount = 1;
  info.colorAttachmentCount = 1;
  info.pColorAttachments = &attachment;
  prepare(commands, 0, list);
  context_.vk().vkCmdBeginRendering(commands.handle(), &info);
  record(commands, {target.view(), size, 0}, {{0, 0}, size});
  context_.vk().vkCmdEndRendering(commands.handle());
}

}  // namespace quintet::gpu
