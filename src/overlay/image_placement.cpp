// SPDX-License-Identifier: Apache-2.0
#include "overlay/image_placement.h"

#include <algorithm>

namespace quintet::overlay {

std::optional<uvec2> ImagePlacement::pixelAt(vec2 screen) const {
  const vec2 position = toImage(screen);
  if (!(position.x >= 0.0f && position.y >= 0.0f)) return std::nullopt;
  const uvec2 pixel(position);
  if (pixel.x >= size.x || pixel.y >= size.y) return std::nullopt;
  return pixel;
}

ImagePlacement fitImage(uvec2 image, vec2 origin, vec2 area, float maxScale) {
  ImagePlacement placement{.origin = origin, .scale = maxScale, .size = image};
  if (image.x == 0 || image.y == 0) return placement;
  const vec2 size(image);
  placement.scale = std::max(std::min({area.x / size.x, area.y / size.y, maxScale}), 1e-6f);
  placement.origin = origin + 0.5f * (area - placement.scale * size);
  if (placement.scale == 1.0f) placement.origin = glm::floor(placement.origin);
  return placement;
}

}  // namespace quintet::overlay
