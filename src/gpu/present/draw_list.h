// SPDX-License-Identifier: Apache-2.0
// Textured triangles in two dimensions: what a user interface draws.
#ifndef QUINTET_GPU_PRESENT_DRAW_LIST_H
#define QUINTET_GPU_PRESENT_DRAW_LIST_H

#include <cstddef>
#include <cstdint>
#include <vector>

namespace quintet::gpu {

struct DrawVertex {
  float x = 0, y = 0;       // pixels from the top left corner
  float u = 0, v = 0;       // texture coordinates
  std::uint32_t color = 0;  // bytes R, G, B, A in memory order, sRGB-encoded, straight alpha; multiplies the texture
};

// Consecutive triangles with the same texture, drawn within a rectangle.
struct DrawCommand {
  std::size_t texture = 0;                         // DrawListRenderer::setTexture
  float left = 0, top = 0, right = 0, bottom = 0;  // pixels
  std::uint32_t firstIndex = 0, indexCount = 0;    // in DrawList::indices
  std::uint32_t firstVertex = 0;                   // added to the indices
  bool external = false;                           // DrawListRenderer::External draws in the rectangle instead
};

struct DrawList {
  std::vector<DrawVertex> vertices;
  std::vector<std::uint16_t> indices;
  std::vector<DrawCommand> commands;  // in the order of drawing
};

}  // namespace quintet::gpu
#endif
