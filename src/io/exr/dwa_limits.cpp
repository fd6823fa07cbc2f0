// SPDX-License-Identifier: Apache-2.0
#include "io/exr/dwa_limits.h"

#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "io/exr/read.h"

namespace quintet::io {
namespace {

constexpr std::size_t kDctBlock = 8;         // pixels per side of the blocks that the cosine transform combines
constexpr std::uint32_t kRowsPerRead = 256;  // a multiple of the rows of a chunk
constexpr float kLargestDecoded = 65024.0f;  // below 65504, because decoders round differently
// Up to this level, the sum of the largest errors of all coefficients of a block and of the three color components is less
// than the distance from kSafeValue to the largest half in DWA's logarithmic scale.
constexpr float kSafeLevel = 500.0f;
constexpr float kSafeValue = 1024.0f;

std::string_view baseName(std::string_view channel) { return channel.substr(channel.rfind('.') + 1); }

}  // namespace

bool isLossyInDwa(std::string_view channel) {
  constexpr auto kNames = std::to_array<std::string_view>({"R", "G", "B", "Y", "RY", "BY"});
  return std::ranges::find(kNames, baseName(channel)) != kNames.end();
}

DwaLimits::DwaLimits(const ExrImage& image, std::span<const ExrChannel* const> channels, std::uint32_t tileSize)
    : image_(image), tileSize_(tileSize) {
  for (const ExrChannel* channel : channels)
    if (channel->type != ExrType::u32 && isLossyInDwa(channel->name)) lossy_.push_back(channel);
}

bool DwaLimits::canOverflow(float level) const {
  if (level > kSafeLevel) return !lossy_.empty();
  return std::ranges::any_of(lossy_, [](const ExrChannel* channel) {
    return std::ranges::any_of(channel->samples, [](float v) { return std::isfinite(v) && std::abs(v) > kSafeValue; });
  });
}

// Blocks begin at the borders of tiles. Chunks of scan lines have a multiple of 8 rows.
std::size_t DwaLimits::blockIndex(std::size_t coordinate) const {
  if (tileSize_ == 0) return coordinate / kDctBlock;
  const std::size_t perTile = (tileSize_ + kDctBlock - 1) / kDctBlock;
  return coordinate / tileSize_ * perTile + coordinate % tileSize_ / kDctBlock;
}

// Returns the coordinates of a column or row of blocks, from first up to end.
std::pair<std::size_t, std::size_t> DwaLimits::pixelsOf(std::size_t block, std::size_t size) const {
  if (tileSize_ == 0) return {block * kDctBlock, std::min((block + 1) * kDctBlock, size)};
  const std::size_t perTile = (tileSize_ + kDctBlock - 1) / kDctBlock;
  const std::size_t tile = block / perTile * tileSize_, first = tile + block % perTile * kDctBlock;
  return {first, std::min({first + kDctBlock, tile + tileSize_, size})};
}

void DwaLimits::clamp(const ExrChannel& channel, std::size_t first, std::span<float> rows) const {
  if (std::ranges::find(lossy_, &channel) == lossy_.end()) return;
  const auto limitTo = [](float& v, float limit) {
    if (std::isfinite(v)) v = std::clamp(v, -limit, limit);
  };
  for (float& v : rows) limitTo(v, kMaxDwaValue);
  const std::size_t width = image_.width, firstRow = first / width, endRow = firstRow + rows.size() / width;
  for (const auto& [block, limit] : limits_) {
    const auto& [layer, column, row] = block;
    if (layer != exrLayerOf(channel.name)) continue;
    const auto [left, right] = pixelsOf(column, width);
    const auto [top, bottom] = pixelsOf(row, image_.height);
    for (std::size_t y = std::max(top, firstRow); y < std::min(bottom, endRow); ++y)
      for (std::size_t x = left; x < right; ++x) limitTo(rows[(y - firstRow) * width + x], limit);
  }
}

// Of all channels of the layer, because DWA encodes red, green and blue as luminance and chroma.
float DwaLimits::largestIn(const Block& block) const {
  const auto& [layer, column, row] = block;
  const auto [left, right] = pixelsOf(column, image_.width);
  const auto [top, bottom] = pixelsOf(row, image_.height);
  float largest = 0.0f;
  for (const ExrChannel* channel : lossy_) {
    if (exrLayerOf(channel->name) != layer) continue;
    for (std::size_t y = top; y < bottom; ++y)
      for (std::size_t x = left; x < right; ++x)
        if (const float v = std::abs(channel->samples[y * image_.width + x]); std::isfinite(v))
          largest = std::max(largest, v);
  }
  return std::min(largest, kMaxDwaValue);
}

bool DwaLimits::tighten(std::span<const std::byte> file, int part) {
  const std::string name = "encoded image";
  const Source source{file, name};
  std::set<Block> broken;
  withExrFile(source, [&](Imf::MultiPartInputFile& input) {
    Imf::InputPart reader(input, part);
    const Imath::Box2i window = reader.header().dataWindow();
    std::vector<std::vector<float>> rows(lossy_.size());
    for (std::uint32_t y = 0; y < image_.height; y += kRowsPerRead) {
      const std::uint32_t count = std::min(kRowsPerRead, image_.height - y);
      const Imath::V2i corner(window.min.x, window.min.y + static_cast<int>(y));
      const Imath::Box2i box(corner, {window.max.x, corner.y + static_cast<int>(count) - 1});
      Imf::FrameBuffer buffers;
      for (std::size_t c = 0; c < lossy_.size(); ++c) {
        rows[c].resize(std::size_t{count} * image_.width);
        buffers.insert(lossy_[c]->name, Imf::Slice::Make(Imf::FLOAT, rows[c].data(), box));
      }
      reader.setFrameBuffer(buffers);
      reader.readPixels(box.min.y, box.max.y);
      for (std::size_t c = 0; c < lossy_.size(); ++c)
        for (std::size_t i = 0; i < rows[c].size(); ++i)
          if (!(std::abs(rows[c][i]) <= kLargestDecoded) &&
              std::isfinite(lossy_[c]->samples[std::size_t{y} * image_.width + i]))
            broken.emplace(exrLayerOf(lossy_[c]->name), blockIndex(i % image_.width), blockIndex(y + i / image_.width));
    }
  });
  for (const Block& block : broken) {
    const auto known = limits_.find(block);
    limits_[block] = 0.5f * (known == limits_.end() ? largestIn(block) : known->second);
  }
  return !broken.empty();
}

}  // namespace quintet::io
