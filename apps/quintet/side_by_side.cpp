#include "side_by_side.h"

#include <array>
#include <cstdint>

namespace quintet::app {
namespace {

constexpr std::uint32_t kGap = 4;     // pixels
constexpr unsigned kBackground = 64;  // of 255

void paste(io::Image& target, const io::Image& source, std::uint32_t left) {
  const io::Image picture = io::toChannels(io::toSrgb8(source), 4);
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    for (std::uint32_t x = 0; x < picture.width; ++x) {
      const auto in = picture.pixel<std::uint8_t>(x, y);
      const auto out = target.pixel<std::uint8_t>(left + x, y);
      const unsigned alpha = in[3];
      for (std::size_t i = 0; i < 3; ++i)
        out[i] = static_cast<std::uint8_t>((in[i] * alpha + kBackground * (255 - alpha) + 127) / 255);
    }
  }
}

}  // namespace

io::Image sideBySide(const io::Image& a, const io::Image& b, const io::Image& difference) {
  io::Image result = io::makeImage(3 * a.width + 2 * kGap, a.height, 3, io::PixelType::u8, io::ColorEncoding::sRgb);
  for (auto& sample : result.samples<std::uint8_t>()) sample = 255;
  std::uint32_t left = 0;
  for (const io::Image* part : std::array{&a, &b, &difference}) {
    paste(result, *part, left);
    left += a.width + kGap;
  }
  return result;
}

}  // namespace quintet::app
