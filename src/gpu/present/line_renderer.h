// SPDX-License-Identifier: Apache-2.0
// Draws antialiased lines with a width and an outline, hidden parts faint and dashed.
#ifndef QUINTET_GPU_PRESENT_LINE_RENDERER_H
#define QUINTET_GPU_PRESENT_LINE_RENDERER_H

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/commands.h"
#include "gpu/image.h"
#include "gpu/present/graphics_pipeline.h"
#include "gpu/present/line_list.h"
#include "gpu/present/swapchain.h"

namespace quintet::gpu {

// Returns the context. Throws Error if its queue cannot draw lines. A context that presents always can.
Context& requireGraphicsQueue(Context& context);

class LineRenderer {
 public:
  // `context` outlives the renderer. `format`: of the targets. Shaders: SPIR-V of shaders/window/lines.vert and .frag.
  // Throws Error as requireGraphicsQueue() does, VulkanError.
  LineRenderer(Context& context, VkFormat format, std::span<const std::uint32_t> vertexShader,
               std::span<const std::uint32_t> fragmentShader);

  // Sets the reversed depths of surfaces, rows from the top; -infinity or the least float where there is no surface. The
  // next prepare() copies them. Null, as at the beginning: nothing hides lines. Throws MemoryError.
  void setDepth(VkExtent2D size, std::shared_ptr<const std::vector<float>> depths);

  // Outside of rendering: uploads the list for record() in the same submission. `slot`: RenderTarget::slot.
  void prepare(Commands& commands, std::uint32_t slot, const LineList& list);
  // During rendering: draws the prepared lines within the rectangle.
  void record(Commands& commands, const RenderTarget& target, const VkRect2D& rectangle);
  // Outside of rendering: prepare(), and record() over the whole image, whose layout is COLOR_ATTACHMENT_OPTIMAL.
  void draw(Commands& commands, const Image& target, const LineList& list,
            VkAttachmentLoadOp load = VK_ATTACHMENT_LOAD_OP_LOAD);

 private:
  void uploadDepth(Commands& commands, std::uint32_t slot);

  Context& context_;
  Sampler sampler_;
  GraphicsPipeline pipeline_;
  Image depth_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  std::shared_ptr<const std::vector<float>> pendingDepths_;  // to copy; null if the image has them
  bool depthWritten_ = false;                                // the image has a layout
  std::array<Buffer, Swapchain::kFramesInFlight> lineBuffers_, staging_;
  LineList prepared_;  // without its lines
  std::uint32_t preparedCount_ = 0, preparedSlot_ = 0;
};

}  // namespace quintet::gpu
#endif
