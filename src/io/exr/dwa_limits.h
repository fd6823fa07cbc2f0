// SPDX-License-Identifier: Apache-2.0
// Private to src/io: keeps the values of a DWA part finite. DWA stores R, G, B, Y, RY and BY as half floats, also those of
// float channels, and its quantization can raise a value above the largest half, which then reads back as infinity. So
// large values are clamped before the encoding, and those that still become infinite are lowered until they do not.
#ifndef QUINTET_IO_EXR_DWA_LIMITS_H
#define QUINTET_IO_EXR_DWA_LIMITS_H

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "io/exr/exr.h"

namespace quintet::io {

// Largest magnitude that is encoded. The distance to the largest half, 65504, is that of a good quantization.
inline constexpr float kMaxDwaValue = 60000.0f;

// Whether DWA changes the values of a channel with this name.
bool isLossyInDwa(std::string_view channel);

class DwaLimits {
 public:
  // `channels`: of the part. `tileSize`: 0 for scan lines. The image must outlive this object.
  DwaLimits(const ExrImage& image, std::span<const ExrChannel* const> channels, std::uint32_t tileSize);

  // Whether quantization of this level can raise a value of the part to infinity.
  bool canOverflow(float level) const;

  // Clamps rows of a channel, whose first value has the index `first` in the image.
  void clamp(const ExrChannel& channel, std::size_t first, std::span<float> rows) const;

  // Reads the part of an encoded file and lowers the limits of the blocks with values that became infinite. Returns
  // whether there are any, so that the file must be encoded again.
  bool tighten(std::span<const std::byte> file, int part);

 private:
  using Block = std::tuple<std::string_view, std::size_t, std::size_t>;  // layer, column, row

  std::size_t blockIndex(std::size_t coordinate) const;
  std::pair<std::size_t, std::size_t> pixelsOf(std::size_t block, std::size_t size) const;
  float largestIn(const Block& block) const;

  const ExrImage& image_;
  std::uint32_t tileSize_;
  std::vector<const ExrChannel*> lossy_;
  std::map<Block, float> limits_;  // of the blocks of 8 x 8 pixels that are transformed together
};

}  // namespace quintet::io
#endif
