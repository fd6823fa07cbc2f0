// SPDX-License-Identifier: Apache-2.0
// Pipelines that rasterize triangles with alpha blending to one color attachment (dynamic rendering).
#ifndef QUINTET_GPU_GRAPHICS_PIPELINE_H
#define QUINTET_GPU_GRAPHICS_PIPELINE_H

#include <cstdint>
#include <span>

#include "gpu/context.h"

namespace quintet::gpu {

struct GraphicsPipelineOptions {
  std::span<const std::uint32_t> vertexShader, fragmentShader;  // SPIR-V; the entry point is main
  VkVertexInputBindingDescription input{};                      // the only vertex buffer
  std::span<const VkVertexInputAttributeDescription> attributes;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkFormat format = VK_FORMAT_UNDEFINED;  // of the color attachment
  const char* purpose = "";               // for messages: "draw the window"
};

// Triangle lists without culling; colors have straight alpha; viewport and scissor are dynamic. Throws VulkanError.
VkPipeline makeGraphicsPipeline(Context& context, const GraphicsPipelineOptions& options);

// Throws Error unless the queue of the device can rasterize. A context that presents always can.
void requireGraphicsQueue(const Context& context);

}  // namespace quintet::gpu
#endif
