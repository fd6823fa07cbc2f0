// SPDX-License-Identifier: Apache-2.0
#include "io/exr_samples.h"

#include <cmath>
#include <limits>

#include "io/exr/cryptomatte.h"

namespace quintet::io::test {
namespace {

float smooth(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  return 2.0f +
         2.0f * std::sin(0.11f * static_cast<float>(x + 3 * seed)) * std::cos(0.07f * static_cast<float>(y + 5 * seed));
}

}  // namespace

ExrImage layeredImage(std::uint32_t width, std::uint32_t height) {
  ExrImage image{width, height, {}};
  std::uint32_t seed = 0;
  const auto add = [&](const char* name, ExrType type, bool exact) {
    ExrChannel channel{name, type, {}, exact};
    for (std::uint32_t y = 0; y < height; ++y)
      for (std::uint32_t x = 0; x < width; ++x) {
        const float value = smooth(x, y, seed);
        channel.samples.push_back(type == ExrType::half ? std::round(value * 256.0f) / 256.0f : value);
      }
    ++seed;
    image.channels.push_back(std::move(channel));
  };
  for (const char* name : {"R", "G", "B", "A", "albedo.R", "albedo.G", "albedo.B"}) add(name, ExrType::half, false);
  for (const char* name : {"normal.X", "normal.Y", "normal.Z", "depth.Z", "uv.U", "uv.V", "CryptoObject00.R",
                           "CryptoObject00.G", "CryptoObject00.B", "CryptoObject00.A"})
    add(name, ExrType::f32, true);
  for (ExrChannel& channel : image.channels) {
    if (channel.name == "depth.Z") channel.samples[0] = std::numeric_limits<float>::infinity();
    if (channel.name == "CryptoObject00.R")
      for (std::size_t i = 0; i < channel.samples.size(); ++i)
        channel.samples[i] = cryptomatteId("object" + std::to_string(i / 7 % 97));
  }
  ExrChannel id{"exact.id", ExrType::u32, {}, true};
  for (std::uint32_t i = 0; i < width * height; ++i) id.integers.push_back(0xffffffffu - 12345u * i);
  image.channels.push_back(std::move(id));
  return image;
}

}  // namespace quintet::io::test
