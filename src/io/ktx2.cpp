// SPDX-License-Identifier: Apache-2.0
// KTX 2.0 (Khronos, version 2.0.4): 2D images in uncompressed formats, BC1 to BC7 and UASTC, with Zstandard or zlib
// supercompression, and ETC1S with BasisLZ. Only level 0, the whole image, is read.
#include <zlib.h>
#include <zstd.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/plural.h"
#include "io/basis_lz.h"
#include "io/block_decode.h"
#include "io/codec.h"
#include "io/formats.h"

namespace quintet::io {
namespace {

constexpr std::string_view kIdentifier{"\xABKTX 20\xBB\r\n\x1A\n", 12};
constexpr std::size_t kHeaderSize = 80;  // with the index
constexpr std::size_t kLevelSize = 24;   // of an entry of the level index

// Largest compression ratios. A block of Zstandard has at most 128 KiB and at least 4 bytes (RFC 8878, section 3.1.1.2).
constexpr std::uint64_t kBestZstandard = 32768;
constexpr std::uint64_t kBestDeflate = 1032;

enum class Supercompression : std::uint32_t { none = 0, basisLz = 1, zstandard = 2, zlib = 3 };

enum class Sample { unorm8, unorm16, half, float32, sharedExponent, packedFloat };

// A value of VkFormat.
struct Layout {
  std::uint32_t format;
  BlockFormat block = BlockFormat::none;
  bool sRgb = false;
  Sample sample = Sample::unorm8;
  std::uint32_t channels = 0;  // stored, of uncompressed formats
  bool bgr = false;
};
constexpr Layout uncompressed(std::uint32_t format, Sample sample, std::uint32_t channels, bool sRgb = false,
                              bool bgr = false) {
  return {format, BlockFormat::none, sRgb, sample, channels, bgr};
}
constexpr Layout blocks(std::uint32_t format, BlockFormat block, bool sRgb = false) { return {format, block, sRgb}; }

constexpr Layout kLayouts[] = {
    uncompressed(9, Sample::unorm8, 1),
    uncompressed(15, Sample::unorm8, 1, true),
    uncompressed(16, Sample::unorm8, 2),
    uncompressed(22, Sample::unorm8, 2, true),
    uncompressed(23, Sample::unorm8, 3),
    uncompressed(29, Sample::unorm8, 3, true),
    uncompressed(30, Sample::unorm8, 3, false, true),
    uncompressed(36, Sample::unorm8, 3, true, true),
    uncompressed(37, Sample::unorm8, 4),
    uncompressed(43, Sample::unorm8, 4, true),
    uncompressed(44, Sample::unorm8, 4, false, true),
    uncompressed(50, Sample::unorm8, 4, true, true),
    uncompressed(70, Sample::unorm16, 1),
    uncompressed(76, Sample::half, 1),
    uncompressed(77, Sample::unorm16, 2),
    uncompressed(83, Sample::half, 2),
    uncompressed(84, Sample::unorm16, 3),
    uncompressed(90, Sample::half, 3),
    uncompressed(91, Sample::unorm16, 4),
    uncompressed(97, Sample::half, 4),
    uncompressed(100, Sample::float32, 1),
    uncompressed(103, Sample::float32, 2),
    uncompressed(106, Sample::float32, 3),
    uncompressed(109, Sample::float32, 4),
    uncompressed(122, Sample::packedFloat, 3),
    uncompressed(123, Sample::sharedExponent, 3),
    blocks(131, BlockFormat::bc1Rgb),
    blocks(132, BlockFormat::bc1Rgb, true),
    blocks(133, BlockFormat::bc1Rgba),
    blocks(134, BlockFormat::bc1Rgba, true),
    blocks(135, BlockFormat::bc2),
    blocks(136, BlockFormat::bc2, true),
    blocks(137, BlockFormat::bc3),
    blocks(138, BlockFormat::bc3, true),
    blocks(139, BlockFormat::bc4),
    blocks(140, BlockFormat::bc4Signed),
    blocks(141, BlockFormat::bc5),
    blocks(142, BlockFormat::bc5Signed),
    blocks(143, BlockFormat::bc6),
    blocks(144, BlockFormat::bc6Signed),
    blocks(145, BlockFormat::bc7),
    blocks(146, BlockFormat::bc7, true),
};

std::uint64_t littleEndian(const Source& source, std::size_t offset, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value |= std::uint64_t{source[offset + i]} << (8 * i);
  return value;
}

struct Header {
  Layout layout;
  std::uint32_t width = 0, height = 0;
  Supercompression supercompression = Supercompression::none;
  std::uint64_t offset = 0, length = 0, size = 0;  // of level 0: in the file; once it is decompressed
  BasisLzLayout basisLz;
  // Channel of a decoded texel for each channel that the file states. Basis Universal stores some pairs as red and alpha.
  std::string_view stored;
  bool premultiplied = false;
  bool bottomUp = false;
  // Of each channel of the image: 0 to 3 for red to alpha of the file, or '0' or '1'.
  std::string swizzle = "rgba";
};

// ---- Basis Universal ----

// The basic block of the data format descriptor (Khronos Data Format Specification 1.4, chapter 5), as far as it is used.
struct Descriptor {
  std::uint32_t model = 0, samples = 0;
  std::uint32_t channel = 0;  // of the first sample
  bool premultiplied = false;
};
Descriptor readDescriptor(const Source& source) {
  constexpr std::uint64_t kFixed = 28, kSample = 16;  // with the total size
  const std::uint64_t at = littleEndian(source, 48, 4), length = littleEndian(source, 52, 4);
  if (length < kFixed || at + length > source.size()) return {};
  const auto start = static_cast<std::size_t>(at);
  const std::uint64_t size = littleEndian(source, start + 10, 2) + 4;  // of the block
  Descriptor descriptor{.model = source[start + 12], .premultiplied = (source[start + 15] & 1) != 0};
  if (size < kFixed || size > length) return descriptor;
  descriptor.samples = static_cast<std::uint32_t>((size - kFixed) / kSample);
  if (descriptor.samples > 0) descriptor.channel = source[start + kFixed + 3] & 15u;
  return descriptor;
}

// Color models.
constexpr std::uint32_t kEtc1s = 163, kUastc = 166;

[[noreturn]] void failForFormat(const Source& source, std::uint32_t format) {
  if (const std::uint32_t model = readDescriptor(source).model; format == 0)
    source.fail(12, fmt::format("KTX2 with the color model {} is not supported", model));
  source.fail(fmt::format("KTX2 with the format {} (VkFormat) is not supported", format));
}

// Layout and channels of a file without VkFormat.
void readBasisUniversal(const Source& source, Header& header) {
  const Descriptor descriptor = readDescriptor(source);
  const bool basisLz = header.supercompression == Supercompression::basisLz;
  if (descriptor.model != (basisLz ? kEtc1s : kUastc)) failForFormat(source, 0);
  if (descriptor.samples == 0) source.fail(48, "KTX2 with an invalid data format descriptor");
  if (basisLz) {
    constexpr std::uint32_t kRed = 3;
    header.basisLz.twoSlices = descriptor.samples > 1;
    if (descriptor.channel == kRed)
      header.stored = header.basisLz.twoSlices ? "ra" : "r";
    else
      header.stored = header.basisLz.twoSlices ? "rgba" : "rgb";
    header.layout = uncompressed(0, Sample::unorm8, static_cast<std::uint32_t>(header.stored.size()));
    return;
  }
  header.layout = blocks(0, BlockFormat::uastc);
  constexpr std::string_view kStored[] = {"rgb", "", "", "rgba", "r", "ra", "rg"};
  if (descriptor.channel < std::size(kStored)) header.stored = kStored[descriptor.channel];
  if (header.stored.empty())
    source.fail(48, fmt::format("UASTC with the channels {} is not supported", descriptor.channel));
}

// The value of a key, without the final zero byte; empty if it does not exist or the entries are not valid.
std::string_view keyValue(const Source& source, std::string_view wanted) {
  const std::uint64_t begin = littleEndian(source, 56, 4), length = littleEndian(source, 60, 4);
  const std::uint64_t end = std::min<std::uint64_t>(begin + length, source.size());
  for (std::uint64_t at = begin; at + 4 <= end;) {
    const std::uint64_t size = littleEndian(source, at, 4);
    if (size > end - at - 4) break;
    const std::string_view entry(reinterpret_cast<const char*>(source.data()) + at + 4, size);
    const std::size_t zero = entry.find('\0');
    if (zero != std::string_view::npos && entry.substr(0, zero) == wanted) {
      const std::string_view value = entry.substr(zero + 1);
      return value.substr(0, value.find('\0'));
    }
    at += 4 + (size + 3) / 4 * 4;
  }
  return {};
}

std::uint32_t channelsOf(const Header& header) { return static_cast<std::uint32_t>(header.stored.size()); }

// Channels that must be decoded for those that are stored.
std::uint32_t decodedChannels(const Header& header) {
  return static_cast<std::uint32_t>(std::string_view("rgba").find(header.stored.back())) + 1;
}

// Channels of the image: without a swizzle those of the format, where red alone becomes gray and red with green gets a
// blue of 0.
std::uint32_t imageChannels(const Header& header) {
  if (header.swizzle != "rgba") return header.swizzle[3] == '1' ? 3 : 4;
  const std::uint32_t stored = channelsOf(header);
  return stored == 2 ? 3 : stored;
}

PixelType imageType(const Layout& layout) {
  if (layout.block != BlockFormat::none) return blockImageInfo(layout.block, 1, 1).type;
  if (layout.sample == Sample::unorm8) return PixelType::u8;
  return layout.sample == Sample::unorm16 ? PixelType::u16 : PixelType::f32;
}

std::uint64_t bytesPerTexel(const Layout& layout) {
  switch (layout.sample) {
    case Sample::unorm8: return layout.channels;
    case Sample::unorm16:
    case Sample::half: return 2 * layout.channels;
    case Sample::float32: return 4 * layout.channels;
    default: return 4;
  }
}

// Bytes of level 0.
std::uint64_t levelSize(const Header& header) {
  const std::uint64_t width = header.width, height = header.height;
  if (header.layout.block == BlockFormat::none) return width * height * bytesPerTexel(header.layout);
  return (width + 3) / 4 * ((height + 3) / 4) * bytesPerBlock(header.layout.block);
}

// The part of the file before the pixels. The pixels need not exist.
Header readHeader(const Source& source) {
  if (source.size() < kHeaderSize + kLevelSize) source.fail(source.size(), "KTX2 data ends early");
  const auto u32 = [&](std::size_t offset) { return static_cast<std::uint32_t>(littleEndian(source, offset, 4)); };
  Header header;
  const std::uint32_t format = u32(12);
  header.supercompression = Supercompression{u32(44)};
  const bool basisLz = header.supercompression == Supercompression::basisLz;
  if (header.supercompression > Supercompression::zlib || (basisLz && format != 0))
    source.fail(44, fmt::format("KTX2 with the supercompression scheme {} is not supported", u32(44)));
  if (u32(28) != 0 || u32(32) > 1 || u32(36) != 1)
    source.fail(28, "KTX2 with a volume, layers (as in videos) or cube faces is not supported; only 2D images are");
  header.width = u32(20), header.height = u32(24);
  if (format == 0) {
    readBasisUniversal(source, header);
  } else {
    const auto layout = std::ranges::find(kLayouts, format, &Layout::format);
    if (layout == std::end(kLayouts)) failForFormat(source, format);
    header.layout = *layout;
    const bool isBlock = layout->block != BlockFormat::none;
    header.stored = std::string_view("rgba").substr(
        0, isBlock ? blockImageInfo(layout->block, header.width, header.height).channels : layout->channels);
  }
  const std::string_view orientation = keyValue(source, "KTXorientation"), swizzle = keyValue(source, "KTXswizzle");
  header.bottomUp = orientation.size() > 1 && orientation[1] == 'u';
  if (swizzle.size() == 4 && swizzle.find_first_not_of("rgba01") == std::string_view::npos) header.swizzle = swizzle;
  header.premultiplied = readDescriptor(source).premultiplied;
  source.checkSize(header.width, header.height, imageChannels(header) * bytesPerSample(imageType(header.layout)));
  header.offset = littleEndian(source, 80, 8), header.length = littleEndian(source, 88, 8);
  if (basisLz) {
    header.basisLz = {.globalOffset = littleEndian(source, 64, 8),
                      .globalLength = littleEndian(source, 72, 8),
                      .levelOffset = header.offset,
                      .levelLength = header.length,
                      .images = std::max(u32(40), 1u),
                      .width = header.width,
                      .height = header.height,
                      .twoSlices = header.basisLz.twoSlices};
    return header;
  }
  header.size = littleEndian(source, 96, 8);
  if (header.size != levelSize(header))
    source.fail(96, fmt::format("KTX2 states {} for level 0; {} x {} pixels have {}", counted(header.size, "byte"),
                                header.width, header.height, levelSize(header)));
  return header;
}

// ---- Pixels ----

std::vector<std::byte> inflateLevel(const Source& source, const Header& header, std::span<const std::byte> level) {
  const bool zstandard = header.supercompression == Supercompression::zstandard;
  source.checkExpansion(header.size, zstandard ? kBestZstandard : kBestDeflate);
  std::vector<std::byte> pixels(header.size);
  if (zstandard) {
    const std::size_t size = ZSTD_decompress(pixels.data(), pixels.size(), level.data(), level.size());
    if (ZSTD_isError(size))
      source.fail(header.offset, fmt::format("broken Zstandard data: {}", ZSTD_getErrorName(size)));
    if (size != pixels.size()) source.fail(header.offset, "KTX2 data ends early");
    return pixels;
  }
  auto size = static_cast<uLongf>(pixels.size());
  const int status = uncompress(reinterpret_cast<Bytef*>(pixels.data()), &size,
                                reinterpret_cast<const Bytef*>(level.data()), static_cast<uLong>(level.size()));
  if (status != Z_OK || size != pixels.size()) source.fail(header.offset, "broken zlib data");
  return pixels;
}

float fromHalf(std::uint32_t bits) {
  const std::uint32_t exponent = bits >> 10 & 31, mantissa = bits & 1023;
  float value = std::ldexp(static_cast<float>(exponent == 0 ? mantissa : mantissa + 1024),
                           static_cast<int>(exponent == 0 ? 1 : exponent) - 25);
  if (exponent == 31) value = mantissa == 0 ? INFINITY : NAN;
  return bits & 0x8000 ? -value : value;
}

// An unsigned float with 5 bits of exponent.
float fromSmallFloat(std::uint32_t bits, std::uint32_t mantissaBits) {
  return fromHalf((bits >> mantissaBits & 31) << 10 | (bits & ((1u << mantissaBits) - 1)) << (10 - mantissaBits));
}

std::uint32_t word(const std::byte* at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value |= std::to_integer<std::uint32_t>(at[i]) << (8 * i);
  return value;
}

// Channels of one texel that the file stores, as samples of the image.
void readTexel(const Layout& layout, const std::byte* at, std::uint8_t* out) {
  for (std::uint32_t c = 0; c < layout.channels; ++c) out[c] = std::to_integer<std::uint8_t>(at[c]);
  if (layout.bgr) std::swap(out[0], out[2]);
}
void readTexel(const Layout& layout, const std::byte* at, std::uint16_t* out) {
  for (std::uint32_t c = 0; c < layout.channels; ++c) out[c] = static_cast<std::uint16_t>(word(at + 2 * c, 2));
}
void readTexel(const Layout& layout, const std::byte* at, float* out) {
  const std::uint32_t bits = word(at, layout.sample == Sample::half ? 2 : 4);
  if (layout.sample == Sample::packedFloat) {
    out[0] = fromSmallFloat(bits & 2047, 6), out[1] = fromSmallFloat(bits >> 11 & 2047, 6);
    out[2] = fromSmallFloat(bits >> 22, 5);
  } else if (layout.sample == Sample::sharedExponent) {
    const float scale = std::ldexp(1.0f, static_cast<int>(bits >> 27) - 24);
    for (std::uint32_t c = 0; c < 3; ++c) out[c] = static_cast<float>(bits >> (9 * c) & 511) * scale;
  } else {
    for (std::uint32_t c = 0; c < layout.channels; ++c) {
      if (layout.sample == Sample::half) {
        out[c] = fromHalf(word(at + 2 * c, 2));
      } else {
        const std::uint32_t single = word(at + 4 * c, 4);
        std::memcpy(&out[c], &single, sizeof single);
      }
    }
  }
}

// Arranges the channels of each texel: `read` fills the stored ones. `one` is the sample value of 1.
template <class T, class Read>
void arrange(const Header& header, Image& image, T one, const Read& read) {
  const std::uint32_t stored = channelsOf(header);
  std::array<T, 4> texel{};
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x) {
      texel = {};
      read(x, header.bottomUp ? image.height - 1 - y : y, texel.data());
      if (stored < 4) texel[3] = one;
      const auto out = image.pixel<T>(x, y);
      for (std::size_t c = 0; c < image.channels; ++c) {
        const std::size_t from = std::string_view("rgba").find(header.swizzle[c]);
        out[c] = from < 4 ? texel[from] : header.swizzle[c] == '1' ? one : T{};
      }
    }
}

// Calls arrange() with the sample type of the image.
template <class Read>
void arrangeAny(const Header& header, Image& image, const Read& read) {
  switch (image.type) {
    case PixelType::u8: return arrange<std::uint8_t>(header, image, 255, read);
    case PixelType::u16: return arrange<std::uint16_t>(header, image, 65535, read);
    case PixelType::f32: return arrange<float>(header, image, 1.0f, read);
  }
}

// ---- The format ----

bool matches(const Source& source) { return source.has(0, kIdentifier); }

// Whether decoded blocks are the image.
bool decodesDirectly(const Header& header) {
  return !header.bottomUp && header.swizzle == "rgba" && decodedChannels(header) == imageChannels(header) &&
         decodedChannels(header) == header.stored.size();
}

ImageInfo probe(const Source& source) {
  const Header header = readHeader(source);
  const bool basisLz = header.supercompression == Supercompression::basisLz;
  ImageInfo info{header.width, header.height, imageChannels(header), imageType(header.layout), {}, 0};
  if (basisLz) info.temporaryBytes = basisLzMemory(header.basisLz);
  if (!basisLz && header.supercompression != Supercompression::none) info.temporaryBytes = header.size;
  if ((basisLz || header.layout.block != BlockFormat::none) && !decodesDirectly(header))
    info.temporaryBytes +=
        std::size_t{header.width} * header.height * decodedChannels(header) * bytesPerSample(info.type);
  return info;
}

Image decodePixels(const Source& source, const Header& header) {
  if (header.offset > source.size() || header.length > source.size() - header.offset)
    source.fail(source.size(), "KTX2 data ends early");
  const bool basisLz = header.supercompression == Supercompression::basisLz;
  const bool compressed = header.supercompression != Supercompression::none && !basisLz;
  if (!compressed && !basisLz && header.length != header.size)
    source.fail(88,
                fmt::format("KTX2 stores {} for level 0 instead of {}", counted(header.length, "byte"), header.size));
  std::span<const std::byte> level = source.bytes.subspan(header.offset, header.length);
  std::vector<std::byte> inflated;
  if (compressed) level = inflated = inflateLevel(source, header, level);

  const PixelType type = imageType(header.layout);
  const auto encoding = type == PixelType::f32 ? ColorEncoding::linear : ColorEncoding::sRgb;
  const auto makeResult = [&] { return makeImage(header.width, header.height, imageChannels(header), type, encoding); };
  if (header.layout.block == BlockFormat::none && !basisLz) {
    Image image = makeResult();
    const std::uint64_t size = bytesPerTexel(header.layout);
    arrangeAny(header, image, [&](std::size_t x, std::size_t y, auto* texel) {
      readTexel(header.layout, level.data() + (y * header.width + x) * size, texel);
    });
    return image;
  }
  Image decoded = basisLz
                      ? decodeBasisLz(source, header.basisLz, decodedChannels(header))
                      : decodeBlocks(header.layout.block, level, header.width, header.height, decodedChannels(header));
  if (decodesDirectly(header)) return decoded;
  Image image = makeResult();
  std::array<std::size_t, 4> from{};  // decoded channel of each stored one
  for (std::size_t c = 0; c < header.stored.size(); ++c) from[c] = std::string_view("rgba").find(header.stored[c]);
  arrangeAny(header, image, [&](std::uint32_t x, std::uint32_t y, auto* texel) {
    const auto values = decoded.pixel<std::remove_pointer_t<decltype(texel)>>(x, y);
    for (std::size_t c = 0; c < header.stored.size(); ++c) texel[c] = values[from[c]];
  });
  return image;
}

Image decode(const Source& source) {
  const Header header = readHeader(source);
  Image image = decodePixels(source, header);
  image.premultiplied = header.premultiplied && image.hasAlpha();
  return image;
}

}  // namespace

const Format kKtx2{"KTX2", matches, probe, decode, nullptr};

}  // namespace quintet::io
