// Pictures and small files for the tests of the codecs, made here: no binary file in the repository.
#ifndef QUINTET_TESTS_IO_SAMPLES_H
#define QUINTET_TESTS_IO_SAMPLES_H

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "io/codec.h"

namespace quintet::io::test {

using Bytes = std::vector<std::byte>;

Bytes bytesOf(std::string_view text);

// Smooth gradients with a little noise; alpha between 1/3 and 1. f32: values from 0 to about 4, linear.
Image makePicture(std::uint32_t width, std::uint32_t height, std::uint32_t channels, PixelType type);

// Quality 0 … 100; sampling: TJSAMP_…; flags: TJFLAG_….
Bytes encodeJpeg(const Image& image, int quality, int sampling, int flags);
// Quality 0 … 100, or -1: lossless.
Bytes encodeWebp(const Image& image, float quality);

// A PNG by hand: `rows` is what the filtered scan lines look like before DEFLATE (stored, not compressed).
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
// Makes all chunk checksums right again, as far as the chunks can be followed.
void repairPngChecksums(Bytes& png);

// One small file of each kind that decodeImage takes.
struct Sample {
  std::string name;
  Bytes bytes;
};
inline void PrintTo(const Sample& sample, std::ostream* out) { *out << sample.name; }  // for GoogleTest
std::vector<Sample> allSamples();

// The file written with OpenEXR directly: what encodeExr does not make.
enum class ExrKind { tiled, mipmapped, offsetWindows, layers, multiPart, piz };
Bytes makeExr(ExrKind kind);

}  // namespace quintet::io::test
#endif
