// SPDX-License-Identifier: Apache-2.0
#include "io/side_by_side.h"

#include <array>
#include <cstdint>

namespace quintet::io {
namespace {

constexpr std::uint32_t kGap = 4;     // pixels
constexpr unsigned kBackground = 64;  // of 255

void paste(Image& target, const Image& source, std::uint32_t left) {
  const Image pixels = toChannels(toSrgb8(source), 4);
  for (std::uint32_t y = 0; y < pixels.height; ++y) {
    for (std::uint32_t x = 0; x < pixels.width; ++x) {
      const auto in = pixels.pixel<std::uint8_t>(x, y);
      const auto out = target.pixel<std::uint8_t>(left + x, y);
      const unsigned alpha = in[3];
      for (std::size_t i = 0; i < 3; ++i)
        out[i] = static_cast<std::uint8_t>((in[i] * alpha + kBackground * (255 - alpha) + 127) / 255);
    }
  }
}

}  // namespace

Image sideBySide(const Image& a, const Image& b, const Image& difference) {
  Image result = makeImage(3 * a.width + 2 * kGap, a.height, 3, PixelType::u8, ColorEncoding::sRgb);
  for (auto& sample : result.samples<std::uint8_t>()) sample = 255;
  std::uint32_t left = 0;
  for (const Image* part : std::array{&a, &b, &difference}) {
    paste(result, *part, left);
    left += a.width + kGap;
  }
  return result;
}

}  // namespace quintet::io
