// SPDX-License-Identifier: Apache-2.0
// JPEG (baseline and progressive, 8 bit) through TurboJPEG.
#include <turbojpeg.h>

#include <cstdint>
#include <memory>
#include <new>

#include "io/formats.h"

namespace quintet::io {
namespace {

// Pixels per byte: each block of 64 pixels takes at least one bit. (Arithmetic coding could compress an image of one
// color further, but no such file is known.)
constexpr std::uint64_t kBestRatio = 512;

struct Destroy {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Decoder = std::unique_ptr<void, Destroy>;

struct Header {
  int width = 0;
  int height = 0;
  std::uint32_t channels = 0;
};

Decoder makeDecoder() {
  Decoder decoder(tjInitDecompress());
  if (!decoder) throw std::bad_alloc();
  return decoder;
}

// Some messages of TurboJPEG start with the name of a function.
[[noreturn]] void failWith(const Source& source, const std::string& message) {
  if (message.find("Premature end") != std::string::npos) source.fail(source.size(), "JPEG data ends early");
  const std::size_t name = message.find("(): ");
  source.fail("broken JPEG: " + (name == std::string::npos ? message : message.substr(name + 4)));
}

// A warning of libjpeg means lost data that it has filled in, which is an error here. One warning is harmless and
// common: padding between segments.
bool onlyPadding(void* decoder) {
  return tjGetErrorCode(decoder) == TJERR_WARNING &&
         std::string_view(tjGetErrorStr2(decoder)).find("extraneous bytes before marker") != std::string_view::npos;
}

Header readHeader(const Source& source, void* decoder) {
  Header header;
  int subsampling = 0;
  int colors = 0;
  if (tjDecompressHeader3(decoder, source.data(), static_cast<unsigned long>(source.size()), &header.width,
                          &header.height, &subsampling, &colors) != 0 &&
      !onlyPadding(decoder))
    failWith(source, tjGetErrorStr2(decoder));
  if (colors == TJCS_CMYK || colors == TJCS_YCCK) source.fail("CMYK JPEG is not supported; convert it to RGB");
  header.channels = colors == TJCS_GRAY ? 1 : 3;
  const auto width = static_cast<std::uint64_t>(header.width);
  const auto height = static_cast<std::uint64_t>(header.height);
  source.checkSize(width, height, header.channels);
  source.checkExpansion(width * height, kBestRatio);
  return header;
}

// Whether libjpeg keeps the coefficients of the whole image: it is progressive, or has several scans.
bool storesCoefficients(const Source& source) {
  std::size_t components = 0;
  for (std::size_t at = 2; at + 10 <= source.size();) {
    const std::uint8_t marker = source[at + 1];
    if (source[at] != 0xFF || marker == 0xFF || marker == 0) {
      ++at;
      continue;
    }
    const bool alone = marker == 1 || (marker >= 0xD0 && marker <= 0xD9);  // without a length
    if (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC) {
      if (marker % 4 == 2) return true;
      components = source[at + 9];
    }
    if (marker == 0xDA) return source[at + 4] < components;
    at += alone ? 2 : 2 + static_cast<std::size_t>(source[at + 2] << 8 | source[at + 3]);
  }
  return false;
}

// In blocks of at most 32 pixels per side.
std::size_t coefficientBytes(const Header& header) {
  const auto rounded = [](int size) { return (static_cast<std::size_t>(size) + 31) / 32 * 32; };
  return rounded(header.width) * rounded(header.height) * header.channels * sizeof(std::int16_t);
}

bool matches(const Source& source) { return source.has(0, "\xff\xd8\xff"); }

ImageInfo probe(const Source& source) {
  const Decoder decoder = makeDecoder();
  const Header header = readHeader(source, decoder.get());
  return {static_cast<std::uint32_t>(header.width),
          static_cast<std::uint32_t>(header.height),
          header.channels,
          PixelType::u8,
          {},
          storesCoefficients(source) ? coefficientBytes(header) : 0};
}

Image decode(const Source& source) {
  const Decoder decoder = makeDecoder();
  const Header header = readHeader(source, decoder.get());
  Image image = makeImage(static_cast<std::uint32_t>(header.width), static_cast<std::uint32_t>(header.height),
                          header.channels, PixelType::u8, ColorEncoding::sRgb);
  const auto run = [&](int flags) {
    return tjDecompress2(decoder.get(), source.data(), static_cast<unsigned long>(source.size()),
                         reinterpret_cast<unsigned char*>(image.data.data()), header.width, 0, header.height,
                         header.channels == 1 ? TJPF_GRAY : TJPF_RGB, flags | TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS);
  };
  // Decoding must continue after a harmless warning, because only then later warnings are reported.
  if (run(TJFLAG_STOPONWARNING) != 0 && !(onlyPadding(decoder.get()) && (run(0) == 0 || onlyPadding(decoder.get()))))
    failWith(source, tjGetErrorStr2(decoder.get()));
  return image;
}

}  // namespace

const Format kJpeg{"JPEG", matches, probe, decode, nullptr};

}  // namespace quintet::io
