// SPDX-License-Identifier: Apache-2.0
#include "job/pixel_groups.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <utility>

namespace quintet::job {

std::vector<PixelGroup> groupAdjacent(uvec2 size, std::span<const uvec2> pixels) {
  // Index + 1 of the pixel that is not in a group yet; 0: none.
  std::vector<std::uint32_t> open(std::size_t{size.x} * size.y, 0u);
  const auto at = [&](std::uint32_t x, std::uint32_t y) -> std::uint32_t& { return open[std::size_t{y} * size.x + x]; };
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    assert(pixels[i].x < size.x && pixels[i].y < size.y);
    at(pixels[i].x, pixels[i].y) = static_cast<std::uint32_t>(i) + 1u;
  }
  std::vector<PixelGroup> groups;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (at(pixels[i].x, pixels[i].y) == 0u) continue;
    PixelGroup group{{}, pixels[i], pixels[i]};
    std::vector<std::size_t> added{i};
    at(pixels[i].x, pixels[i].y) = 0u;
    while (!added.empty()) {
      const std::size_t member = added.back();
      added.pop_back();
      group.members.push_back(member);
      const uvec2 pixel = pixels[member];
      group.least = glm::min(group.least, pixel);
      group.most = glm::max(group.most, pixel);
      for (std::uint32_t y = std::max(pixel.y, 1u) - 1u; y < std::min(pixel.y + 2u, size.y); ++y)
        for (std::uint32_t x = std::max(pixel.x, 1u) - 1u; x < std::min(pixel.x + 2u, size.x); ++x)
          if (const std::uint32_t next = std::exchange(at(x, y), 0u); next > 0u) added.push_back(next - 1u);
    }
    std::ranges::sort(group.members);
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace quintet::job
