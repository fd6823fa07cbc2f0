// SPDX-License-Identifier: Apache-2.0
// Lines in two dimensions with a depth, which LineRenderer tests against the depth of surfaces.
//
// Depths are reversed: larger is nearer to the camera. They must change linearly over the image along a line, as 1/z
// does for a perspective camera and -z for an orthographic one.
#ifndef QUINTET_GPU_PRESENT_LINE_LIST_H
#define QUINTET_GPU_PRESENT_LINE_LIST_H

#include <cstdint>
#include <vector>

namespace quintet::gpu {

// With round ends: a line without length is a disk. The layout is that of the inputs of shaders/window/lines.vert.
struct Line {
  float ax = 0, ay = 0, bx = 0, by = 0;     // ends, pixels of the target from the top left corner
  float depthA = 0, depthB = 0;             // reversed depths of the ends
  float opacityA = 1, opacityB = 1;         // of the ends, [0,1]; linear between
  std::uint32_t color = 0xFFFFFFFF;         // bytes R, G, B, A in memory order, sRGB-encoded, straight alpha
  std::uint32_t outlineColor = 0xFF000000;  // the same
  float width = 2;                          // pixels, without the outline
  float outline = 1;                        // pixels on each side
};

struct LineList {
  std::vector<Line> lines;  // in the order of drawing; all outlines are below all lines

  // Where the pixels of the depth image are: pixel (x, y) covers depthScale² pixels of the target from
  // (depthX + depthScale · x, depthY + depthScale · y) on.
  float depthX = 0, depthY = 0, depthScale = 1;
  // A line is hidden where its depth is less than that of the surface by more than
  // relativeBias · |depth of the surface| + bias.
  float relativeBias = 0, bias = 0;
  float hiddenOpacity = 0.5f;  // factor of the opacity of hidden parts
  float dash = 5;              // pixels: length of dashes and gaps of hidden parts; 0: they are solid
};

}  // namespace quintet::gpu
#endif
