// SPDX-License-Identifier: Apache-2.0
// WebP (lossy, lossless, alpha) through libwebp. libwebp accepts some missing bytes at the end, so the sizes in the
// RIFF container are checked here.
#include <webp/decode.h>

#include <cstring>
#include <memory>
#include <new>

#include "io/formats.h"

namespace quintet::io {
namespace {

constexpr std::size_t kRiffHeader = 12;  // "RIFF", size, "WEBP"
constexpr std::size_t kChunkHeader = 8;  // name, size

struct FreeBuffer {
  void operator()(WebPDecBuffer* buffer) const { WebPFreeDecBuffer(buffer); }
};

std::size_t littleEndian32(const Source& source, std::size_t offset) {
  std::size_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= static_cast<std::size_t>(source[offset + i]) << (8 * i);
  return value;
}

bool matches(const Source& source) { return source.has(0, "RIFF") && source.has(8, "WEBP"); }

// Fails unless every chunk is complete.
void checkContainer(const Source& source) {
  const std::size_t end = littleEndian32(source, 4) + kChunkHeader;
  if (end > source.size()) source.fail(source.size(), "WebP data ends early");
  for (std::size_t at = kRiffHeader; at < end;) {
    const std::size_t size = end - at < kChunkHeader ? end : littleEndian32(source, at + 4);
    if (at + kChunkHeader + size > end) source.fail(at, "broken WebP: a chunk reaches beyond the end");
    at += kChunkHeader + size + size % 2;
  }
}

[[noreturn]] void failWith(const Source& source, VP8StatusCode status) {
  switch (status) {
    case VP8_STATUS_OUT_OF_MEMORY: throw std::bad_alloc();
    case VP8_STATUS_NOT_ENOUGH_DATA:
    case VP8_STATUS_SUSPENDED: source.fail(source.size(), "WebP data ends early");
    case VP8_STATUS_UNSUPPORTED_FEATURE: source.fail("WebP with a feature that is not supported");
    default: source.fail("broken WebP: the image data is corrupt");
  }
}

WebPBitstreamFeatures readHeader(const Source& source) {
  WebPBitstreamFeatures features{};
  const VP8StatusCode status = WebPGetFeatures(source.data(), source.size(), &features);
  if (status != VP8_STATUS_OK) failWith(source, status);
  if (features.has_animation) source.fail("animated WebP is not supported");
  source.checkSize(static_cast<std::uint64_t>(features.width), static_cast<std::uint64_t>(features.height),
                   features.has_alpha ? 4 : 3);
  return features;
}

ImageInfo probe(const Source& source) {
  const WebPBitstreamFeatures features = readHeader(source);
  const std::size_t pixels = static_cast<std::size_t>(features.width) * static_cast<std::size_t>(features.height);
  return {static_cast<std::uint32_t>(features.width),
          static_cast<std::uint32_t>(features.height),
          features.has_alpha ? 4u : 3u,
          PixelType::u8,
          {},
          pixels * (features.has_alpha ? 4 : 3)};  // libwebp's own buffer
}

Image decode(const Source& source) {
  checkContainer(source);
  WebPDecoderConfig config;
  if (!WebPInitDecoderConfig(&config)) source.fail("the libwebp library and its headers have different versions");
  config.input = readHeader(source);
  const bool alpha = config.input.has_alpha != 0;
  config.output.colorspace = alpha ? MODE_RGBA : MODE_RGB;
  // libwebp allocates its own buffer and touches it only when pixels are decoded. A file of 30 bytes whose header
  // declares 16383 x 16383 pixels therefore costs no memory.
  const VP8StatusCode status = WebPDecode(source.data(), source.size(), &config);
  const std::unique_ptr<WebPDecBuffer, FreeBuffer> buffer(&config.output);
  if (status != VP8_STATUS_OK) failWith(source, status);
  Image image =
      makeImage(static_cast<std::uint32_t>(config.input.width), static_cast<std::uint32_t>(config.input.height),
                alpha ? 4 : 3, PixelType::u8, ColorEncoding::sRgb);
  const WebPRGBABuffer& rows = config.output.u.RGBA;
  for (std::uint32_t y = 0; y < image.height; ++y)
    std::memcpy(image.data.data() + y * image.rowBytes(), rows.rgba + y * static_cast<std::size_t>(rows.stride),
                image.rowBytes());
  return image;
}

}  // namespace

const Format kWebp{"WebP", matches, probe, decode, nullptr};

}  // namespace quintet::io
