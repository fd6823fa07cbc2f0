// SPDX-License-Identifier: Apache-2.0
#include "io/basis_lz.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "io/basis_bits.h"

namespace quintet::io {
namespace {

constexpr std::uint64_t kGlobalHeader = 20, kImageDescription = 20;

using EtcColor = std::array<std::uint8_t, 4>;  // the last value is not used

// What all slices of a file share.
struct BasisCodebooks {
  std::vector<std::array<EtcColor, 4>> palettes;  // colors of an endpoint, by the value of a texel
  std::vector<std::uint32_t> selectors;           // values of the texels of a block: two bits each, in rows
};
struct BasisCodes {
  explicit BasisCodes(BasisBits& bits)
      : prediction(bits), endpointDelta(bits), selector(bits), selectorRun(bits), historySize(bits.read(13)) {}
  BasisCode prediction, endpointDelta, selector, selectorRun;
  std::uint32_t historySize;
};

struct BlockIndices {
  std::uint16_t endpoint, selector;
};

// A part of the file.
struct BasisRange {
  std::uint64_t offset, length;
};

struct GlobalData {
  std::uint32_t endpoints = 0, selectors = 0;
  BasisRange endpointBytes{}, selectorBytes{}, codeBytes{};
  std::array<BasisRange, 2> slices{};
};

std::uint32_t wordAt(const Source& source, std::uint64_t offset, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i)
    value |= std::uint32_t{source[static_cast<std::size_t>(offset) + i]} << (8 * i);
  return value;
}

GlobalData readGlobalData(const Source& source, const BasisLzLayout& layout) {
  const std::uint64_t begin = layout.globalOffset, tables = kGlobalHeader + kImageDescription * layout.images;
  if (begin > source.size() || layout.globalLength > source.size() - begin || layout.globalLength < tables)
    source.fail(source.size(), "KTX2 data ends early");
  GlobalData data;
  data.endpoints = wordAt(source, begin, 2), data.selectors = wordAt(source, begin + 2, 2);
  if (data.endpoints == 0 || data.selectors == 0) source.fail(begin, "BasisLZ data without endpoints or selectors");
  std::uint64_t at = begin + tables;
  const auto take = [&](std::uint64_t field) {
    const BasisRange range{at, wordAt(source, begin + field, 4)};
    at += range.length;
    if (at > begin + layout.globalLength)
      source.fail(begin + field, "a part of the BasisLZ data is longer than the data");
    return range;
  };
  data.endpointBytes = take(4), data.selectorBytes = take(8), data.codeBytes = take(12);

  const std::uint64_t description = begin + kGlobalHeader;
  constexpr std::uint32_t kPredictedFrame = 2;
  if (wordAt(source, description, 4) & kPredictedFrame)
    source.fail(description, "KTX2 with the frames of a video is not supported; only 2D images are");
  for (std::size_t i = 0; i < (layout.twoSlices ? 2u : 1u); ++i) {
    const std::uint64_t field = description + 4 + 8 * i;
    const std::uint64_t offset = wordAt(source, field, 4), length = wordAt(source, field + 4, 4);
    if (length == 0) source.fail(field + 4, "a slice of the BasisLZ data is missing");
    if (offset + length > layout.levelLength) source.fail(field, "a slice of the BasisLZ data is outside of level 0");
    data.slices[i] = {layout.levelOffset + offset, length};
  }
  return data;
}

BasisBits bitsOf(const Source& source, const BasisRange& range) { return {source, range.offset, range.length}; }

std::size_t blockCount(const BasisLzLayout& layout) {
  return std::size_t{layout.width + 3} / 4 * (std::size_t{layout.height + 3} / 4);
}

// ---- Codebooks ----

// Colors of a base color with 5 bits and an intensity (Khronos Data Format Specification 1.4, chapter 21).
std::array<EtcColor, 4> paletteOf(const std::array<std::uint32_t, 3>& base, std::uint32_t intensity) {
  constexpr std::int32_t kModifiers[8][2] = {{2, 8},   {5, 17},  {9, 29},   {13, 42},
                                             {18, 60}, {24, 80}, {33, 106}, {47, 183}};
  const auto [small, large] = kModifiers[intensity];
  std::array<EtcColor, 4> palette{};
  for (std::size_t v = 0; v < 4; ++v) {
    const std::int32_t size = v == 0 || v == 3 ? large : small, modifier = v < 2 ? -size : size;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto value = static_cast<std::int32_t>(base[c] << 3 | base[c] >> 2);
      palette[v][c] = static_cast<std::uint8_t>(std::clamp(value + modifier, 0, 255));
    }
  }
  return palette;
}

std::vector<std::array<EtcColor, 4>> readPalettes(BasisBits bits, std::uint32_t count) {
  // Codes for differences to a previous value of up to 9, up to 21, and more.
  const std::array<BasisCode, 3> colorDelta{BasisCode(bits), BasisCode(bits), BasisCode(bits)};
  const BasisCode intensityDelta(bits);
  const std::size_t stored = bits.read(1) == 1 ? 1 : 3;
  std::array<std::uint32_t, 3> color{16, 16, 16};
  std::uint32_t intensity = 0;
  std::vector<std::array<EtcColor, 4>> palettes(count);
  for (std::array<EtcColor, 4>& palette : palettes) {
    intensity = (intensity + intensityDelta(bits)) & 7;
    for (std::size_t c = 0; c < stored; ++c) {
      const BasisCode& delta = colorDelta[color[c] <= 9 ? 0 : color[c] <= 21 ? 1 : 2];
      color[c] = (color[c] + delta(bits)) & 31;
    }
    if (stored == 1) color[1] = color[2] = color[0];
    palette = paletteOf(color, intensity);
  }
  return palettes;
}

std::vector<std::uint32_t> readSelectors(BasisBits bits, std::uint32_t count) {
  if (bits.read(2) != 0) bits.fail("the selectors of BasisLZ have an unknown form");
  const bool raw = bits.read(1) == 1;
  std::vector<std::uint32_t> selectors(count);
  const auto readRaw = [&] {
    const std::uint32_t low = bits.read(16);
    return low | bits.read(16) << 16;
  };
  if (raw) {
    for (std::uint32_t& selector : selectors) selector = readRaw();
    return selectors;
  }
  const BasisCode delta(bits);
  selectors[0] = readRaw();
  for (std::size_t i = 1; i < count; ++i) {
    std::uint32_t change = 0;
    for (std::uint32_t row = 0; row < 4; ++row) change |= (delta(bits) & 255) << (8 * row);
    selectors[i] = selectors[i - 1] ^ change;
  }
  return selectors;
}

// ---- Slices ----

// Selectors of earlier blocks, the often used ones first.
class SelectorHistory {
 public:
  explicit SelectorHistory(std::uint32_t size) : values_(size), next_(size / 2) {}
  std::size_t size() const { return values_.size(); }
  std::uint32_t operator[](std::size_t i) const { return values_[i]; }
  void add(std::uint32_t selector) {
    if (values_.empty()) return;
    values_[next_++] = selector;
    if (next_ == values_.size()) next_ = values_.size() / 2;
  }
  void moveToFront(std::size_t i) { std::swap(values_[i / 2], values_[i]); }

 private:
  std::vector<std::uint32_t> values_;
  std::size_t next_;
};

class SliceReader {
 public:
  SliceReader(BasisBits bits, const BasisCodes& codes, const BasisCodebooks& books)
      : bits_(bits),
        codes_(codes),
        endpointCount_(static_cast<std::uint32_t>(books.palettes.size())),
        selectorCount_(static_cast<std::uint32_t>(books.selectors.size())),
        history_(codes.historySize) {}

  // The blocks in rows.
  std::vector<BlockIndices> read(std::size_t columns, std::size_t rows) {
    std::vector<BlockIndices> blocks(columns * rows);
    // Predictions for the second row of each group of 2 x 2 blocks.
    std::vector<std::uint32_t> below((columns + 1) / 2);
    std::uint32_t predictions = 0, endpoint = 0;
    for (std::size_t y = 0; y < rows; ++y)
      for (std::size_t x = 0; x < columns; ++x) {
        if (x % 2 == 0 && y % 2 == 0) {
          predictions = readPredictions();
          below[x / 2] = predictions >> 4;
        } else if (x % 2 == 0) {
          predictions = below[x / 2];
        }
        BlockIndices* block = &blocks[y * columns + x];
        endpoint = readEndpoint(predictions & 3, block, x, y, columns, endpoint);
        predictions >>= 2;
        *block = {static_cast<std::uint16_t>(endpoint), static_cast<std::uint16_t>(readSelector())};
      }
    return blocks;
  }

 private:
  // How the endpoints of the next 2 x 2 blocks are predicted: two bits for each.
  std::uint32_t readPredictions() {
    constexpr std::uint32_t kRepeat = 256, kLeastRepeat = 3;
    if (repeatedPredictions_ > 0) {
      --repeatedPredictions_;
      return predictions_;
    }
    const std::uint32_t symbol = codes_.prediction(bits_);
    if (symbol > kRepeat) bits_.fail("a prediction of BasisLZ is not valid");
    if (symbol < kRepeat)
      predictions_ = symbol;
    else
      repeatedPredictions_ = std::uint64_t{bits_.readGroups(4)} + kLeastRepeat - 1;
    return predictions_;
  }

  std::uint32_t readEndpoint(std::uint32_t prediction, const BlockIndices* block, std::size_t x, std::size_t y,
                             std::size_t columns, std::uint32_t previous) {
    enum Prediction : std::uint32_t { left, above, aboveLeft, difference };
    if (prediction == difference) {
      std::uint32_t endpoint = previous + codes_.endpointDelta(bits_);
      if (endpoint >= endpointCount_) endpoint -= endpointCount_;
      if (endpoint >= endpointCount_) bits_.fail("an endpoint of BasisLZ is not valid");
      return endpoint;
    }
    if ((prediction != above && x == 0) || (prediction != left && y == 0))
      bits_.fail("a prediction of BasisLZ is outside of the image");
    if (prediction == left) return previous;
    return (block - columns - (prediction == aboveLeft ? 1 : 0))->endpoint;
  }

  std::uint32_t readSelector() {
    constexpr std::uint32_t kLongRun = 63, kLeastRun = 3;
    std::uint32_t symbol = selectorCount_;  // the first one of the history
    if (repeatedSelectors_ > 0) {
      --repeatedSelectors_;
    } else {
      symbol = codes_.selector(bits_);
      if (symbol == selectorCount_ + history_.size()) {
        const std::uint32_t run = codes_.selectorRun(bits_);
        repeatedSelectors_ = std::uint64_t{run == kLongRun ? bits_.readGroups(7) : run} + kLeastRun - 1;
        symbol = selectorCount_;
      }
    }
    std::uint32_t selector = symbol;
    if (symbol < selectorCount_) {
      history_.add(symbol);
    } else {
      const std::size_t i = symbol - selectorCount_;
      if (i >= history_.size() || history_[i] >= selectorCount_) bits_.fail("a selector of BasisLZ is not valid");
      selector = history_[i];
      history_.moveToFront(i);
    }
    return selector;
  }

  BasisBits bits_;
  const BasisCodes& codes_;
  std::uint32_t endpointCount_, selectorCount_;
  SelectorHistory history_;
  std::uint32_t predictions_ = 0;
  std::uint64_t repeatedPredictions_ = 0, repeatedSelectors_ = 0;
};

// Writes `Count` channels of the palettes, from channel `from` on, to the channels of the image from `first` on.
template <std::size_t Count>
void paintSlice(std::span<const BlockIndices> blocks, const BasisCodebooks& books, std::size_t from, std::size_t first,
                Image& image) {
  const std::size_t columns = (image.width + 3) / 4, channels = image.channels, rowBytes = image.rowBytes();
  auto* const pixels = reinterpret_cast<std::uint8_t*>(image.data.data());
  parallelRanges((image.height + 3) / 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      for (std::size_t column = 0; column < columns; ++column) {
        const BlockIndices block = blocks[row * columns + column];
        const std::array<EtcColor, 4>& palette = books.palettes[block.endpoint];
        std::uint32_t selector = books.selectors[block.selector];
        const std::size_t width = std::min<std::size_t>(4, image.width - 4 * column);
        const std::size_t height = std::min<std::size_t>(4, image.height - 4 * row);
        std::uint8_t* start = pixels + 4 * row * rowBytes + 4 * column * channels + first;
        for (std::size_t y = 0; y < height; ++y, start += rowBytes, selector >>= 8) {
          std::uint8_t* out = start;
          for (std::size_t x = 0; x < width; ++x, out += channels)
            std::copy_n(palette[selector >> (2 * x) & 3].data() + from, Count, out);
        }
      }
  });
}

}  // namespace

std::size_t basisLzMemory(const BasisLzLayout& layout) {
  constexpr std::size_t kMostEntries = 65535;  // of a codebook
  return kMostEntries * (sizeof(std::array<EtcColor, 4>) + sizeof(std::uint32_t)) +
         blockCount(layout) * sizeof(BlockIndices);
}

Image decodeBasisLz(const Source& source, const BasisLzLayout& layout, std::uint32_t channels) {
  const GlobalData data = readGlobalData(source, layout);
  BasisCodebooks books;
  books.palettes = readPalettes(bitsOf(source, data.endpointBytes), data.endpoints);
  books.selectors = readSelectors(bitsOf(source, data.selectorBytes), data.selectors);
  BasisBits codeBits = bitsOf(source, data.codeBytes);
  const BasisCodes codes(codeBits);

  Image image = makeImage(layout.width, layout.height, channels, PixelType::u8, ColorEncoding::sRgb);
  const auto readSlice = [&](std::size_t slice) {
    return SliceReader(bitsOf(source, data.slices[slice]), codes, books)
        .read((layout.width + 3) / 4, (layout.height + 3) / 4);
  };
  if (channels == 1)
    paintSlice<1>(readSlice(0), books, 0, 0, image);
  else
    paintSlice<3>(readSlice(0), books, 0, 0, image);
  // The three values of a color are the same in the second slice, except for what the codebook loses: the reference
  // transcoder uses green.
  if (layout.twoSlices && channels > 3) paintSlice<1>(readSlice(1), books, 1, 3, image);
  return image;
}

}  // namespace quintet::io
