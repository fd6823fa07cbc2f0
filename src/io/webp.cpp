// WebP (lossy, lossless, alpha) through libwebp. libwebp forgives some lost bytes at the end; the RIFF
// container says how many there should be, so the container is checked here.
#include <webp/decode.h>

#include <new>

#include "io/formats.h"

namespace quintet::io {
namespace {

constexpr std::size_t kRiffHeader = 12;  // "RIFF", size, "WEBP"
constexpr std::size_t kChunkHeader = 8;  // name, size

std::size_t littleEndian32(const Source& source, std::size_t offset) {
  std::size_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= static_cast<std::size_t>(source[offset + i]) << (8 * i);
  return value;
}

bool matches(const Source& source) { return source.has(0, "RIFF") && source.has(8, "WEBP"); }

// Every chunk must be there in full.
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
  return {static_cast<std::uint32_t>(features.width), static_cast<std::uint32_t>(features.height),
          features.has_alpha ? 4u : 3u, PixelType::u8, {}};
}

Image decode(const Source& source) {
  checkContainer(source);
  WebPDecoderConfig config;
  if (!WebPInitDecoderConfig(&config)) source.fail("libwebp is of another version than its headers");
  config.input = readHeader(source);
  const bool alpha = config.input.has_alpha != 0;
  Image image = makeImage(static_cast<std::uint32_t>(config.input.width),
                          static_cast<std::uint32_t>(config.input.height), alpha ? 4 : 3, PixelType::u8,
                          ColorEncoding::sRgb);
  config.output.colorspace = alpha ? MODE_RGBA : MODE_RGB;
  config.output.is_external_memory = 1;
  config.output.u.RGBA.rgba = reinterpret_cast<std::uint8_t*>(image.data.data());
  config.output.u.RGBA.stride = static_cast<int>(image.rowBytes());
  config.output.u.RGBA.size = image.data.size();
  const VP8StatusCode status = WebPDecode(source.data(), source.size(), &config);
  WebPFreeDecBuffer(&config.output);
  if (status != VP8_STATUS_OK) failWith(source, status);
  return image;
}

}  // namespace

const Format kWebp{"WebP", matches, probe, decode, nullptr};

}  // namespace quintet::io
