// SPDX-License-Identifier: Apache-2.0
// Draws lists of textured triangles with alpha blending.
#ifndef QUINTET_GPU_PRESENT_DRAW_LIST_RENDERER_H
#define QUINTET_GPU_PRESENT_DRAW_LIST_RENDERER_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/commands.h"
#include "gpu/image.h"
#include "gpu/present/draw_list.h"
#include "gpu/present/graphics_pipeline.h"
#include "gpu/present/swapchain.h"

namespace quintet::gpu {

class DrawListRenderer {
 public:
  // `context` (ContextOptions::surface) outlives the renderer. `format`: of the targets. Shaders: SPIR-V of
  // shaders/window/triangles.vert and .frag. Throws VulkanError.
  DrawListRenderer(Context& context, VkFormat format, std::span<const std::uint32_t> vertexShader,
                   std::span<const std::uint32_t> fragmentShader);

  // Sets the pixels of a texture: RGBA bytes, rows from the top. The next draw() copies them. A texture is created on
  // its first use. Throws MemoryError if a side is 0 or larger than the device supports.
  void setTexture(std::size_t texture, VkExtent2D size, std::shared_ptr<const std::vector<std::byte>> pixels,
                  VkFilter filter = VK_FILTER_LINEAR);

  // Records what DrawCommand::external stands for, within the rectangle. It can bind any state.
  using External = std::function<void(Commands& commands, const RenderTarget& target, const VkRect2D& rectangle)>;

  // Fills the target with the color {R, G, B, A}, in [0,1], and draws the list. Commands with a texture that was never
  // set are skipped, as are external ones without `external`.
  void draw(Commands& commands, const RenderTarget& target, const DrawList& list,
            const std::array<float, 4>& background, const External& external = {});

 private:
  struct Texture {
    Image image;
    VkDescriptorSet set = VK_NULL_HANDLE;
    VkFilter filter = VK_FILTER_LINEAR;
    std::shared_ptr<const std::vector<std::byte>> pending;  // pixels to copy; null if the image has them
    bool written = false;                                   // the image has a layout
  };
  struct FrameBuffers {
    Buffer vertices, indices, staging;
  };

  void uploadTextures(Commands& commands, FrameBuffers& frame);
  void uploadTriangles(FrameBuffers& frame, const DrawList& list);
  void bind(Commands& commands, const RenderTarget& target, const FrameBuffers& frame);
  void record(Commands& commands, const RenderTarget& target, const DrawList& list, const FrameBuffers& frame,
              const External& external);

  Context& context_;
  Sampler linear_, nearest_;
  GraphicsPipeline pipeline_;
  std::vector<Texture> textures_;
  std::array<FrameBuffers, Swapchain::kFramesInFlight> frames_;
};

}  // namespace quintet::gpu
#endif
