// SPDX-License-Identifier: Apache-2.0
#include "overlay/line_image.h"

#include <cstddef>
#include <cstring>
#include <utility>

#include "gpu/buffer.h"
#include "gpu/image.h"
#include "gpu/present/line_renderer.h"

namespace quintet::overlay {
namespace {

constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_UNORM;

}  // namespace

io::Image drawLines(gpu::Context& context, const WindowShaders& shaders, const io::Image& image,
                    const gpu::LineList& list, uvec2 depthSize, std::shared_ptr<const std::vector<float>> depths) {
  gpu::LineRenderer renderer(context, kFormat, shaders.vertex, shaders.fragment);
  if (depths) renderer.setDepth({depthSize.x, depthSize.y}, std::move(depths));
  io::Image rgba = io::toChannels(image, 4);
  const gpu::Image target(context, {.width = image.width,
                                    .height = image.height,
                                    .format = kFormat,
                                    .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                                    .name = "image with lines"});
  const gpu::Buffer upload(context,
                           {.size = target.byteSize(), .memory = gpu::Memory::upload, .name = "image without lines"});
  const gpu::Buffer readback(context,
                             {.size = target.byteSize(), .memory = gpu::Memory::readback, .name = "image with lines"});
  std::memcpy(upload.mapped(), rgba.data.data(), rgba.data.size());
  context.submitAndWait([&](gpu::Commands& commands) {
    commands.transition(target, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    commands.copy(upload, target);
    commands.transition(target, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    renderer.draw(commands, target, list);
    commands.transition(target, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    commands.copy(target, readback);
    commands.toHost(gpu::Stage::transfer);
  });
  std::memcpy(rgba.data.data(), readback.mapped(), rgba.data.size());
  return io::toChannels(rgba, image.channels);
}

}  // namespace quintet::overlay
