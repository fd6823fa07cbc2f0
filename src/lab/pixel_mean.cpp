// SPDX-License-Identifier: Apache-2.0
#include "lab/pixel_mean.h"

#include <cstdint>

#include <fmt/format.h>

#include "base/error.h"

namespace quintet::lab {

std::vector<float> pixelMean(const io::Image& image, uvec2 begin, uvec2 size) {
  const auto fits = [](std::uint32_t first, std::uint32_t count, std::uint32_t all) {
    return count > 0 && first < all && count <= all - first;
  };
  if (!fits(begin.x, size.x, image.width) || !fits(begin.y, size.y, image.height))
    throw UsageError(fmt::format("the {}x{} pixels at {},{} are not inside the image of {}x{}", size.x, size.y, begin.x,
                                 begin.y, image.width, image.height));
  std::vector<double> sum(image.channels, 0.0);
  for (std::uint32_t y = begin.y; y < begin.y + size.y; ++y)
    for (std::uint32_t x = begin.x; x < begin.x + size.x; ++x) {
      const auto pixel = image.pixel<float>(x, y);
      for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += static_cast<double>(pixel[c]);
    }
  const double count = static_cast<double>(size.x) * static_cast<double>(size.y);
  std::vector<float> mean;
  for (const double channel : sum) mean.push_back(static_cast<float>(channel / count));
  return mean;
}

}  // namespace quintet::lab
