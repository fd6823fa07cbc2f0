// SPDX-License-Identifier: Apache-2.0
// Images and small files for the codec tests. They are generated, so the repository contains no binary files.
#ifndef QUINTET_TESTS_IO_SAMPLES_H
#define QUINTET_TESTS_IO_SAMPLES_H

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/codec.h"

namespace quintet::io::test {

using Bytes = std::vector<std::byte>;

Bytes bytesOf(std::string_view text);

// Returns smooth gradients with a little noise. Alpha is between 1/3 and 1; f32 samples are linear values from 0 to
// about 4.
Image makeGradient(std::uint32_t width, std::uint32_t height, std::uint32_t channels, PixelType type);

// `quality` is in [0,100], `sampling` is TJSAMP_…, `flags` are TJFLAG_….
Bytes encodeJpeg(const Image& image, int quality, int sampling, int flags);
// `quality` is in [0,100]; -1 means lossless.
Bytes encodeWebp(const Image& image, float quality);

// The parts of a PNG. `rows` are the filtered scan lines before DEFLATE (stored, not compressed).
struct PngParts {
  std::uint32_t width = 1;
  std::uint32_t height = 1;
  std::uint8_t bitDepth = 8;
  std::uint8_t colorType = 0;
  std::uint8_t interlace = 0;
  std::vector<std::pair<std::string, std::string>> chunks;  // name and data, between IHDR and IDAT
  std::string rows;
};
Bytes makePng(const PngParts& parts);
// Updates the checksums of all chunks up to the first invalid chunk size.
void repairPngChecksums(Bytes& png);

// One small file of each kind that decodeImage supports.
struct Sample {
  std::string name;
  Bytes bytes;
};
inline void PrintTo(const Sample& sample, std::ostream* out) { *out << sample.name; }  // for GoogleTest
std::vector<Sample> allSamples();

// Kinds of files that encodeExr cannot write; makeExr uses OpenEXR directly.
enum class ExrKind { tiled, mipmapped, offsetWindows, layers, multiPart, piz };
Bytes makeExr(ExrKind kind);

}  // namespace quintet::io::test
#endif
