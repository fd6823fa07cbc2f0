// SPDX-License-Identifier: Apache-2.0
// Where an image is on the screen, so that lines and the pointer meet its pixels.
#ifndef QUINTET_OVERLAY_IMAGE_PLACEMENT_H
#define QUINTET_OVERLAY_IMAGE_PLACEMENT_H

#include <optional>

#include "base/math.h"

namespace quintet::overlay {

// Where the image is on the screen. Both have their origin in the top left corner.
struct ImagePlacement {
  vec2 origin{0.0f};   // of the image, screen coordinates
  float scale = 1.0f;  // screen coordinates per pixel of the image, > 0
  uvec2 size{0};       // of the image, pixels

  vec2 toImage(vec2 screen) const { return (screen - origin) / scale; }
  // The pixel below a position on the screen; nothing outside of the image.
  std::optional<uvec2> pixelAt(vec2 screen) const;
};

// The largest placement of an image in a rectangle of the screen, in its middle. At most `maxScale`; whole pixels if
// the scale is 1.
ImagePlacement fitImage(uvec2 image, vec2 origin, vec2 area, float maxScale);

}  // namespace quintet::overlay
#endif
