// SPDX-License-Identifier: Apache-2.0
// BC1 to BC5 (Khronos Data Format Specification 1.3, chapters 18 and 19), and the loop over the blocks of an image.
#include "io/block_decode.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"

namespace quintet::io {
namespace {

constexpr std::size_t kTexels = 16;

std::uint64_t littleEndian(const std::byte* bytes, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value |= std::to_integer<std::uint64_t>(bytes[i]) << (8 * i);
  return value;
}

using Color = std::array<std::uint32_t, 4>;

Color fromRgb565(std::uint32_t bits) {
  const std::uint32_t r = bits >> 11, g = bits >> 5 & 63, b = bits & 31;
  return {r << 3 | r >> 2, g << 2 | g >> 4, b << 3 | b >> 2, 255};
}

// Section 18.1. Four colors, or three and black if the first one is not larger and `threeColors` is set; that black is
// transparent if `transparent`.
void decodeColors(const std::byte* block, bool threeColors, bool transparent, std::uint8_t* rgba) {
  const auto first = static_cast<std::uint32_t>(littleEndian(block, 2));
  const auto second = static_cast<std::uint32_t>(littleEndian(block + 2, 2));
  std::array<Color, 4> colors{fromRgb565(first), fromRgb565(second)};
  const bool three = threeColors && first <= second;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::uint32_t a = colors[0][c], b = colors[1][c];
    colors[2][c] = three ? (a + b + 1) / 2 : (2 * a + b + 1) / 3;
    colors[3][c] = three ? 0 : (a + 2 * b + 1) / 3;
  }
  colors[2][3] = 255;
  colors[3][3] = three && transparent ? 0 : 255;
  const std::uint64_t indices = littleEndian(block + 4, 4);
  for (std::size_t i = 0; i < kTexels; ++i)
    for (std::size_t c = 0; c < 4; ++c) rgba[4 * i + c] = static_cast<std::uint8_t>(colors[indices >> (2 * i) & 3][c]);
}

// Section 19.1: eight values between two endpoints, or six and the limits of the range.
template <class Value>
void decodeChannel(const std::byte* block, bool isSigned, Value value) {
  const auto endpoint = [&](std::size_t i) {
    const auto byte = std::to_integer<std::uint8_t>(block[i]);
    if (!isSigned) return static_cast<float>(byte) / 255.0f;
    return std::max(static_cast<float>(static_cast<std::int8_t>(byte)) / 127.0f, -1.0f);
  };
  const float a = endpoint(0), b = endpoint(1);
  const auto raw = [&](std::size_t i) {
    const auto byte = std::to_integer<std::uint8_t>(block[i]);
    return isSigned ? int{static_cast<std::int8_t>(byte)} : int{byte};
  };
  std::array<float, 8> values{a, b};
  const bool eight = raw(0) > raw(1);
  const int steps = eight ? 7 : 5;
  for (int k = 1; k < steps; ++k)
    values[static_cast<std::size_t>(k) + 1] =
        (static_cast<float>(steps - k) * a + static_cast<float>(k) * b) / static_cast<float>(steps);
  if (!eight) values[6] = isSigned ? -1.0f : 0.0f, values[7] = 1.0f;
  const std::uint64_t indices = littleEndian(block + 2, 6);
  for (std::size_t i = 0; i < kTexels; ++i) value(i, values[indices >> (3 * i) & 7]);
}

void decodeBc2Alpha(const std::byte* block, std::uint8_t* rgba) {
  const std::uint64_t bits = littleEndian(block, 8);
  for (std::size_t i = 0; i < kTexels; ++i) rgba[4 * i + 3] = static_cast<std::uint8_t>((bits >> (4 * i) & 15) * 17);
}

std::uint8_t toByte(float value) { return static_cast<std::uint8_t>(value * 255.0f + 0.5f); }

// Texels of one block as RGBA.
void decodeByteBlock(BlockFormat format, const std::byte* block, std::uint8_t* rgba) {
  switch (format) {
    case BlockFormat::bc1Rgb:
    case BlockFormat::bc1Rgba: return decodeColors(block, true, format == BlockFormat::bc1Rgba, rgba);
    case BlockFormat::bc2: decodeColors(block + 8, false, false, rgba); return decodeBc2Alpha(block, rgba);
    case BlockFormat::bc3:
      decodeColors(block + 8, false, false, rgba);
      return decodeChannel(block, false, [&](std::size_t i, float v) { rgba[4 * i + 3] = toByte(v); });
    case BlockFormat::uastc: return decodeUastcBlock(block, rgba);
    default: return decodeBc7Block(block, rgba);
  }
}

// Texels of one block as RGB floats, or one float for BC4.
void decodeFloatBlock(BlockFormat format, const std::byte* block, std::size_t channels, float* texels) {
  const bool isSigned = format == BlockFormat::bc4Signed || format == BlockFormat::bc5Signed;
  switch (format) {
    case BlockFormat::bc6: return decodeBc6Block(block, false, texels);
    case BlockFormat::bc6Signed: return decodeBc6Block(block, true, texels);
    default: break;
  }
  std::fill_n(texels, kTexels * channels, 0.0f);
  decodeChannel(block, isSigned, [&](std::size_t i, float v) { texels[channels * i] = v; });
  if (channels > 1) decodeChannel(block + 8, isSigned, [&](std::size_t i, float v) { texels[channels * i + 1] = v; });
}

// Writes the texels of a block that are inside of the image.
template <class T, class From, class Convert>
void storeBlock(Image& image, std::uint32_t blockX, std::uint32_t blockY, const From* texels, std::size_t stride,
                Convert convert) {
  const std::size_t channels = image.channels, width = std::min(4u, image.width - 4 * blockX);
  for (std::uint32_t y = 0; y < 4 && 4 * blockY + y < image.height; ++y) {
    T* out = image.pixel<T>(4 * blockX, 4 * blockY + y).data();
    for (std::size_t x = 0; x < width; ++x, out += channels)
      for (std::size_t c = 0; c < channels; ++c) out[c] = convert(texels[stride * (4 * y + x) + c]);
  }
}

}  // namespace

std::size_t bytesPerBlock(BlockFormat format) {
  switch (format) {
    case BlockFormat::none: return 0;
    case BlockFormat::bc1Rgb:
    case BlockFormat::bc1Rgba:
    case BlockFormat::bc4:
    case BlockFormat::bc4Signed: return 8;
    default: return 16;
  }
}

ImageInfo blockImageInfo(BlockFormat format, std::uint32_t width, std::uint32_t height) {
  ImageInfo info{width, height, 4, PixelType::u8, {}};
  switch (format) {
    case BlockFormat::bc1Rgb: info.channels = 3; break;
    case BlockFormat::bc4: info.channels = 1, info.type = PixelType::u16; break;
    case BlockFormat::bc5: info.channels = 3, info.type = PixelType::u16; break;
    case BlockFormat::bc4Signed: info.channels = 1, info.type = PixelType::f32; break;
    case BlockFormat::bc5Signed:
    case BlockFormat::bc6:
    case BlockFormat::bc6Signed: info.channels = 3, info.type = PixelType::f32; break;
    default: break;
  }
  return info;
}

Image decodeBlocks(BlockFormat format, std::span<const std::byte> blocks, std::uint32_t width, std::uint32_t height,
                   std::uint32_t channels) {
  const ImageInfo info = blockImageInfo(format, width, height);
  Image image = makeImage(width, height, std::min(info.channels, channels), info.type,
                          info.type == PixelType::f32 ? ColorEncoding::linear : ColorEncoding::sRgb);
  const std::uint32_t columns = (width + 3) / 4, rows = (height + 3) / 4;
  const std::size_t size = bytesPerBlock(format);
  parallelRanges(rows, [&](std::size_t first, std::size_t last) {
    std::array<std::uint8_t, 4 * kTexels> bytes{};
    std::array<float, 3 * kTexels> floats{};
    for (std::size_t y = first; y < last; ++y)
      for (std::uint32_t x = 0; x < columns; ++x) {
        const std::byte* block = blocks.data() + (y * columns + x) * size;
        const auto row = static_cast<std::uint32_t>(y);
        if (info.type == PixelType::u8) {
          decodeByteBlock(format, block, bytes.data());
          storeBlock<std::uint8_t>(image, x, row, bytes.data(), 4, [](std::uint8_t v) { return v; });
          continue;
        }
        decodeFloatBlock(format, block, info.channels, floats.data());
        if (info.type == PixelType::u16)
          storeBlock<std::uint16_t>(image, x, row, floats.data(), info.channels,
                                    [](float v) { return static_cast<std::uint16_t>(v * 65535.0f + 0.5f); });
        else
          storeBlock<float>(image, x, row, floats.data(), info.channels, [](float v) { return v; });
      }
  });
  return image;
}

}  // namespace quintet::io
