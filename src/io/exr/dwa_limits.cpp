// SPDX-License-Identifier: Apache-2.0
#include "io/exr/dwa_limits.h"

#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

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

void DwaLimits::clamp(const ExrChannel& channel, std::size_t first, std::span<float> rows) const {
  if (std::ranges::find(lossy_, &channel) == lossy_.end()) return;
  for (float& v : rows)
    if (std::isfinite(v)) v = std::clamp(v, -kMaxDwaValue, kMaxDwaValue);
  if (limits_.empty()) return;
  const std::string_view layer = exrLayerOf(channel.name);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t x = (first + i) % image_.width, y = (first + i) / image_.width;
    const auto limit = limits_.find({layer, blockIndex(x), blockIndex(y)});
    if (limit != limits_.end() && std::isfinite(rows[i])) rows[i] = std::clamp(rows[i], -limit->second, limit->second);
  }
}

// Of all channels of the layer, because DWA encodes red, green and blue as luminance and chroma.
float DwaLimits::largestIn(const Block& block) const {
  const auto& [layer, column, row] = block;
  const auto range = [&](std::size_t index, std::size_t size) {
    const std::size_t perTile = (tileSize_ + kDctBlock - 1) / kDctBlock;
    const std::size_t begin =
        tileSize_ == 0 ? index * kDctBlock : index / perTile * tileSize_ + index % perTile * kDctBlock;
    std::size_t end = begin + kDctBlock;
    if (tileSize_ > 0) end = std::min(end, (begin / tileSize_ + 1) * tileSize_);
    return std::pair(begin, std::min(end, size));
  };
  const auto [left, right] = range(column, image_.width);
  const auto [top, bottom] = range(row, image_.height);
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
