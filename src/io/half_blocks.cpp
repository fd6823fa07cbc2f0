// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cassert>
#include <cstdlib>

#include <fmt/format.h>

#include "io/terminal_image.h"

namespace quintet::io {
namespace {

using Rgb = std::array<int, 3>;

Rgb colorAt(const Image& image, std::uint32_t x, std::uint32_t y) {
  const auto pixel = image.pixel<std::uint8_t>(x, y);
  return {pixel[0], pixel[1], pixel[2]};
}

int squaredDistance(const Rgb& a, const Rgb& b) {
  int sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

// The nearest color of the xterm palette: 16 to 231 are a cube of 6 levels per channel, 232 to 255 are gray.
int paletteIndex(const Rgb& color) {
  constexpr std::array<int, 6> kLevels{0, 95, 135, 175, 215, 255};
  Rgb cube{};
  int index = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto nearest = std::ranges::min_element(kLevels, {}, [&](int level) { return std::abs(level - color[c]); });
    cube[c] = *nearest;
    index = 6 * index + static_cast<int>(nearest - kLevels.begin());
  }
  const int step = std::clamp(((color[0] + color[1] + color[2]) / 3 - 3) / 10, 0, 23);
  const int gray = 8 + 10 * step;
  return squaredDistance(color, {gray, gray, gray}) < squaredDistance(color, cube) ? 232 + step : 16 + index;
}

// The parameter of a color: "2;255;0;0" or "5;196".
std::string parameter(const Rgb& color, bool trueColor) {
  return trueColor ? fmt::format("2;{};{};{}", color[0], color[1], color[2]) : fmt::format("5;{}", paletteIndex(color));
}

}  // namespace

std::string encodeHalfBlocks(const Image& image, bool trueColor) {
  assert(image.channels == 3);
  std::string text;
  for (std::uint32_t y = 0; y < image.height; y += 2) {
    std::string upper, lower;  // as the terminal has them
    for (std::uint32_t x = 0; x < image.width; ++x) {
      std::string color = parameter(colorAt(image, x, y), trueColor);
      if (color != upper) text += fmt::format("\x1b[38;{}m", upper = std::move(color));
      if (y + 1 < image.height) {
        color = parameter(colorAt(image, x, y + 1), trueColor);
        if (color != lower) text += fmt::format("\x1b[48;{}m", lower = std::move(color));
      }
      text += "\u2580";
    }
    text += "\x1b[0m\r\n";
  }
  return text;
}

}  // namespace quintet::io
