// OpenEXR with any set of channels: layers, AOVs, checkpoints. codec.h has the simple form.
#ifndef QUINTET_IO_EXR_H
#define QUINTET_IO_EXR_H

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/codec.h"

namespace quintet::io {

// How a channel is stored. u32 is for ids and counts, exact in our floats up to 2^24.
enum class ExrType : std::uint8_t { half, f32, u32 };

struct ExrChannel {
  std::string name;  // "R", or "layer.R"; unique in the picture
  ExrType type = ExrType::half;
  std::vector<float> samples;  // height · width, rows top to bottom
};

struct ExrPicture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<ExrChannel> channels;
  Metadata metadata;  // string attributes; a name that OpenEXR itself uses ("compression") is a UsageError
};

// Scan lines, ZIP, sorted channels as the format wants. Finite values beyond half's range clamp to ±65504;
// u32 rounds to the nearest value in range. Throws UsageError (sizes that disagree, names used twice).
std::vector<std::byte> encodeExr(const ExrPicture& picture);

// Every channel of the first flat part, cropped and padded with 0 to the display window; channels in
// alphabetical order. Throws FileError, also for subsampled channels and deep data.
ExrPicture decodeExr(std::span<const std::byte> bytes, const std::string& nameForErrors);

}  // namespace quintet::io
#endif
