// SPDX-License-Identifier: Apache-2.0
// Pipelines that rasterize triangles with alpha blending to one color attachment (dynamic rendering), and read one image.
#ifndef QUINTET_GPU_PRESENT_GRAPHICS_PIPELINE_H
#define QUINTET_GPU_PRESENT_GRAPHICS_PIPELINE_H

#include <cstddef>
#include <cstdint>
#include <span>

#include "gpu/buffer.h"
#include "gpu/commands.h"
#include "gpu/image.h"

namespace quintet::gpu {

struct GraphicsPipelineOptions {
  std::span<const std::uint32_t> vertexShader, fragmentShader;  // SPIR-V; the entry point is main
  VkVertexInputBindingDescription input{};                      // the only vertex buffer
  std::span<const VkVertexInputAttributeDescription> attributes;
  std::uint32_t constantBytes = 0;        // of the push constants, which both shaders can read
  std::uint32_t maxSets = 0;              // number of descriptor sets, with those that frames in flight still use
  VkFormat format = VK_FORMAT_UNDEFINED;  // of the color attachment
  const char* purpose = "";               // for messages: "draw the window"
};

// Triangle lists without culling; colors have straight alpha. Can be destroyed while frames in flight use it.
class GraphicsPipeline {
 public:
  // `context` outlives the pipeline. Throws VulkanError.
  GraphicsPipeline(Context& context, const GraphicsPipelineOptions& options);
  ~GraphicsPipeline();
  GraphicsPipeline(const GraphicsPipeline&) = delete;
  GraphicsPipeline& operator=(const GraphicsPipeline&) = delete;

  // Returns a descriptor set with the image, which is in VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL when it is used.
  VkDescriptorSet makeSet(const Image& image, const Sampler& sampler);
  void freeSet(VkDescriptorSet set);  // when the frames in flight have ended; null has no effect

  // Binds the pipeline and its vertices, and sets the viewport to the target. The scissor is dynamic.
  void bind(Commands& commands, const Buffer& vertices, VkExtent2D target) const;
  void bindSet(Commands& commands, VkDescriptorSet set) const;
  template <class T>
  void setConstants(Commands& commands, const T& constants) const {
    setConstants(commands, std::as_bytes(std::span(&constants, 1)));
  }

 private:
  void createLayouts(const GraphicsPipelineOptions& options);
  void destroy();
  void setConstants(Commands& commands, std::span<const std::byte> bytes) const;

  Context& context_;
  VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

}  // namespace quintet::gpu
#endif
