// Pictures as files. Reading: PNG, JPEG, WebP, Radiance HDR and OpenEXR, told apart by content, never by
// name. Writing: PNG, OpenEXR, Radiance HDR. A picture comes whole or not at all: data that ends early, a
// wrong checksum, or a size beyond the limits is a FileError "name: byte 312: PNG data ends early".
#ifndef QUINTET_IO_CODEC_H
#define QUINTET_IO_CODEC_H

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/image.h"

namespace quintet::io {

inline constexpr std::uint32_t kMaxImageSide = 65536;                // pixels
inline constexpr std::size_t kMaxImageBytes = std::size_t{1} << 30;  // decoded

struct ImageInfo {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t channels = 0;  // that decodeImage would give
  PixelType type = PixelType::u8;
  std::string_view format;  // "PNG", "JPEG", "WebP", "Radiance HDR", "OpenEXR"
};

// Keyword and text, in the file's order. Keywords: 1 … 79 bytes of printable ASCII; text: UTF-8.
using Metadata = std::vector<std::pair<std::string, std::string>>;

// What comes out, by format:
//   PNG           u8 (up to 8 bits) or u16, 1 … 4 channels; palettes and tRNS are expanded
//   JPEG          u8, 1 or 3 channels (CMYK is refused)
//   WebP          u8, 3 or 4 channels (of an animation: refused)
//   Radiance HDR  f32, 3 channels, turned to the usual orientation, divided by the header's EXPOSURE
//   OpenEXR       f32, 1 … 4 channels, premultiplied; the first part with Y or R, G, B (else the first layer
//                 with R, G, B; else the only channel); what the display window shows, 0 outside the data window
// Integer formats are labelled sRgb and straight, float formats linear. Colour chunks and profiles are
// ignored, as glTF 2.0 (3.8.3) demands of textures; so is the Exif orientation.
// `nameForErrors`: a path, or what the caller calls these bytes. Throws FileError.
Image decodeImage(std::span<const std::byte> bytes, const std::string& nameForErrors);
Image readImage(const std::filesystem::path& file);

// From the header alone: a broken picture behind it goes unnoticed. Throws FileError.
ImageInfo probeImage(std::span<const std::byte> bytes, const std::string& nameForErrors);

// PNG: the text chunks before the pixels; OpenEXR: string attributes, sorted; other formats have none here.
Metadata readMetadata(std::span<const std::byte> bytes, const std::string& nameForErrors);

// Encoders are deterministic: the same picture gives the same bytes. They throw UsageError for a picture
// without pixels, for bad keywords, and where noted.

// u8 or u16 (floats: UsageError; toSrgb8 makes bytes); premultiplied alpha is an error, too. sRGB-encoded
// pictures get an sRGB chunk, linear ones gAMA 1. Text goes to tEXt chunks, or to iTXt if it is not ASCII;
// empty text is left out.
std::vector<std::byte> encodePng(const Image& image, const Metadata& metadata = {});

// Any image, written as linear half floats (finite values clamp to ±65504), channels Y, A, R, G, B as there
// are, premultiplied, ZIP. More channels, layers, floats: io/exr.h.
std::vector<std::byte> encodeExr(const Image& image, const Metadata& metadata = {});

// Any image, written as run-length encoded RGBE: 8 bit mantissas, alpha dropped (premultiplied over black),
// negative values and NaN become 0.
std::vector<std::byte> encodeHdr(const Image& image);

// Encodes by the extension (.png .exr .hdr, any case; "-" is PNG on standard output; others: UsageError)
// and writes with quintet::writeFile. PNG: floats pass through toSrgb8, premultiplied alpha is divided out.
void writeImage(const std::filesystem::path& file, const Image& image, const Metadata& metadata = {});

}  // namespace quintet::io
#endif
