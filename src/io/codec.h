// SPDX-License-Identifier: Apache-2.0
// Image files. Reads PNG, JPEG, WebP, Radiance HDR, OpenEXR and KTX2, detected by content and not by name; writes PNG,
// OpenEXR and Radiance HDR. Decoding returns the complete image or fails: truncated data, a wrong checksum, or a size
// above the limits is a FileError such as "name: byte 312: PNG data ends early".
#ifndef QUINTET_IO_CODEC_H
#define QUINTET_IO_CODEC_H

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "io/image.h"

namespace quintet {
class MemoryBudget;
}

namespace quintet::io {

// Decodes an image. The result depends on the format:
//   PNG           u8 (up to 8 bits) or u16, 1 to 4 channels; palettes and tRNS are expanded
//   JPEG          u8, 1 or 3 channels; CMYK is not supported
//   WebP          u8, 3 or 4 channels; animations are not supported
//   Radiance HDR  f32, 3 channels, in top-to-bottom orientation, divided by the EXPOSURE of the header
//   OpenEXR       f32, 1 to 4 channels, premultiplied; the first part with Y or R, G, B, otherwise the first layer with
//                 R, G, B, otherwise the only channel; the display window, with 0 outside the data window
//   KTX2          u8, u16 or f32, 1, 3 or 4 channels: level 0 of a 2D image, uncompressed, BC1 to BC7, or Basis Universal
//                 (ETC1S, UASTC)
// Integer formats are sRGB-encoded with straight alpha, unless a KTX2 file states that alpha is premultiplied; float formats
// are linear. Color chunks and profiles are ignored, as glTF 2.0 (3.8.3) requires for textures; so is the Exif orientation.
// `nameForErrors` is a path or another name of the bytes. What the header states counts in the budget before it is
// allocated. Without a budget, 80 % of the machine's memory are the limit. Throws FileError, MemoryError.
Image decodeImage(std::span<const std::byte> bytes, const std::string& nameForErrors);
Image decodeImage(std::span<const std::byte> bytes, const std::string& nameForErrors, MemoryBudget&);
// The same for a file, whose bytes count while the image is decoded.
Image readImage(const std::filesystem::path& file);
Image readImage(const std::filesystem::path& file, MemoryBudget&);
// The same, as linear floats (toFloat), for an environment.
Image readRadiance(const std::filesystem::path& file, MemoryBudget&);

// Reads the header only, so corrupt pixel data is not detected. Throws FileError.
ImageInfo probeImage(std::span<const std::byte> bytes, const std::string& nameForErrors);

// Returns the text chunks before the pixels (PNG) or the sorted string attributes (OpenEXR); empty for other formats.
Metadata readMetadata(std::span<const std::byte> bytes, const std::string& nameForErrors);

// Encoders are deterministic: the same image gives the same bytes. They throw UsageError for an image without pixels,
// for invalid keywords, and where noted.

// Encodes u8 or u16 with straight alpha; floats (see toSrgb8) and premultiplied alpha are UsageErrors. sRGB-encoded
// images get an sRGB chunk, linear ones gAMA 1. ASCII text is written as tEXt, other text as iTXt; empty text is
// skipped.
std::vector<std::byte> encodePng(const Image& image, const Metadata& metadata = {});

// Encodes any image as premultiplied linear half floats (finite values are clamped to ±65504) in the channels Y or R,
// G, B and A, with ZIP compression. io/exr/exr.h writes layers and other types.
std::vector<std::byte> encodeExr(const Image& image, const Metadata& metadata = {});

// Encodes any image as run-length encoded RGBE with 8 bit mantissas. Alpha is premultiplied and dropped; negative
// values and NaN become 0.
std::vector<std::byte> encodeHdr(const Image& image);

// Encodes in the format of the extension (.png .exr .hdr, any case; "-" is PNG on standard output; others are a
// UsageError) and writes with quintet::writeFile. For PNG, floats and premultiplied alpha are converted by toSrgb8.
void writeImage(const std::filesystem::path& file, const Image& image, const Metadata& metadata = {});

}  // namespace quintet::io
#endif
