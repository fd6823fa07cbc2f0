// SPDX-License-Identifier: Apache-2.0
// Sixel graphics (DEC STD 070, chapter 9): bands of 6 rows; in each band, one pass for each of its colors.
#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/terminal_image.h"

namespace quintet::io {
namespace {

constexpr std::size_t kColors = 256;
constexpr std::uint32_t kBand = 6;  // rows

using Rgb = std::array<int, 3>;

// ---- Palette: median cut (Heckbert 1982) of a histogram with 5 bits per channel

constexpr std::size_t kBins = 32 * 32 * 32;

std::size_t binOf(const Rgb& color) {
  return static_cast<std::size_t>(color[0] >> 3 << 10 | color[1] >> 3 << 5 | color[2] >> 3);
}

struct Bin {
  std::size_t index = 0;
  std::uint64_t count = 0;  // of pixels
  std::array<std::uint64_t, 3> sum{};

  std::uint64_t mean(std::size_t channel) const { return sum[channel] / count; }
};

// Bins that share a color.
struct Box {
  std::span<Bin> bins;
  std::uint64_t count = 0;   // of pixels
  std::size_t axis = 0;      // the channel with the largest extent
  std::uint64_t extent = 0;  // 0 if there is one bin
};

Box makeBox(std::span<Bin> bins) {
  Box box{.bins = bins};
  for (const Bin& bin : bins) box.count += bin.count;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto mean = [c](const Bin& bin) { return bin.mean(c); };
    const auto [low, high] = std::ranges::minmax_element(bins, {}, mean);
    if (high->mean(c) - low->mean(c) <= box.extent) continue;
    box.axis = c;
    box.extent = high->mean(c) - low->mean(c);
  }
  return box;
}

// Splits at the median of the pixels; both parts have a bin.
std::pair<Box, Box> split(const Box& box) {
  std::ranges::sort(box.bins, {}, [&](const Bin& bin) { return std::pair(bin.mean(box.axis), bin.index); });
  std::size_t first = 1;
  std::uint64_t count = box.bins[0].count;
  while (first + 1 < box.bins.size() && count + box.bins[first].count <= box.count / 2)
    count += box.bins[first++].count;
  return {makeBox(box.bins.first(first)), makeBox(box.bins.subspan(first))};
}

std::vector<Bin> histogram(const Image& image) {
  std::vector<Bin> bins(kBins);
  const auto samples = image.samples<std::uint8_t>();
  for (std::size_t i = 0; i < samples.size(); i += 3) {
    Bin& bin = bins[binOf({samples[i], samples[i + 1], samples[i + 2]})];
    ++bin.count;
    for (std::size_t c = 0; c < 3; ++c) bin.sum[c] += samples[i + c];
  }
  for (std::size_t i = 0; i < kBins; ++i) bins[i].index = i;
  std::erase_if(bins, [](const Bin& bin) { return bin.count == 0; });
  return bins;
}

class Palette {
 public:
  explicit Palette(const Image& image) : nearest_(kBins, kUnknown) {
    std::vector<Bin> bins = histogram(image);
    std::vector<Box> boxes{makeBox(bins)};
    while (boxes.size() < kColors) {
      const auto worst = std::ranges::max_element(boxes, {}, [](const Box& box) { return box.count * box.extent; });
      if (worst->extent == 0) break;
      const auto [low, high] = split(*worst);
      *worst = low;
      boxes.push_back(high);
    }
    for (const Box& box : boxes) add(box);
  }

  // In percent, as sixel has them.
  const std::vector<Rgb>& percents() const { return percents_; }
  // With 8 bits per channel.
  const Rgb& color(std::size_t index) const { return colors_[index]; }

  std::size_t nearest(const Rgb& color) {
    std::uint16_t& known = nearest_[binOf(color)];
    if (known == kUnknown) {
      const auto distance = [&](const Rgb& other) {
        int sum = 0;
        for (std::size_t c = 0; c < 3; ++c) sum += (other[c] - color[c]) * (other[c] - color[c]);
        return sum;
      };
      known = static_cast<std::uint16_t>(std::ranges::min_element(colors_, {}, distance) - colors_.begin());
    }
    return known;
  }

 private:
  static constexpr std::uint16_t kUnknown = 0xFFFF;

  void add(const Box& box) {
    Rgb percent{}, color{};
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint64_t sum = 0;
      for (const Bin& bin : box.bins) sum += bin.sum[c];
      percent[c] = static_cast<int>((sum * 100 + box.count * 255 / 2) / (box.count * 255));
      color[c] = (percent[c] * 255 + 50) / 100;
    }
    for (const Bin& bin : box.bins) nearest_[bin.index] = static_cast<std::uint16_t>(colors_.size());
    percents_.push_back(percent);
    colors_.push_back(color);
  }

  std::vector<Rgb> percents_, colors_;
  std::vector<std::uint16_t> nearest_;  // for each bin
};

// ---- Pixels

// The palette index of each pixel. The error of a pixel is distributed to the pixels on the right and below.
std::vector<std::uint8_t> dither(const Image& image, Palette& palette) {
  std::vector<std::uint8_t> indices;
  indices.reserve(image.pixelCount());
  // In sixteenths, with a margin of one pixel on both sides.
  std::vector<Rgb> errors(image.width + 2), below(image.width + 2);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const auto pixel = image.pixel<std::uint8_t>(x, y);
      Rgb wanted{};
      for (std::size_t c = 0; c < 3; ++c) wanted[c] = std::clamp(pixel[c] + errors[x + 1][c] / 16, 0, 255);
      const std::size_t index = palette.nearest(wanted);
      indices.push_back(static_cast<std::uint8_t>(index));
      for (std::size_t c = 0; c < 3; ++c) {
        const int error = wanted[c] - palette.color(index)[c];
        errors[x + 2][c] += 7 * error;
        below[x][c] += 3 * error;
        below[x + 1][c] += 5 * error;
        below[x + 2][c] += error;
      }
    }
    errors.swap(below);
    std::ranges::fill(below, Rgb{});
  }
  return indices;
}

// Sixels of one color: 6 bits for each column, run-length encoded.
void appendRuns(std::string& text, std::span<const std::uint8_t> columns) {
  for (std::size_t x = 0; x < columns.size();) {
    std::size_t end = x;
    while (end < columns.size() && columns[end] == columns[x]) ++end;
    const char sixel = static_cast<char>('?' + columns[x]);
    if (end == columns.size() && columns[x] == 0) return;
    if (end - x > 3)
      text += fmt::format("!{}{}", end - x, sixel);
    else
      text.append(end - x, sixel);
    x = end;
  }
}

}  // namespace

std::string encodeSixel(const Image& image) {
  assert(image.channels == 3 && !image.empty());
  Palette palette(image);
  const std::vector<std::uint8_t> indices = dither(image, palette);
  // Save the cursor; pixels that are not set stay; square pixels; size.
  std::string text = fmt::format(
      "\x1b"
      "7\x1bP0;1q\"1;1;{};{}",
      image.width, image.height);
  const std::size_t colors = palette.percents().size();
  for (std::size_t i = 0; i < colors; ++i) {
    const Rgb& color = palette.percents()[i];
    text += fmt::format("#{};2;{};{};{}", i, color[0], color[1], color[2]);
  }
  std::vector<std::uint8_t> columns(colors * image.width);  // of each color in the band
  std::vector<bool> used(colors);
  for (std::uint32_t band = 0; band < image.height; band += kBand) {
    if (band > 0) text += '-';
    std::ranges::fill(columns, std::uint8_t{0});
    used.assign(colors, false);
    for (std::uint32_t y = band; y < std::min(band + kBand, image.height); ++y)
      for (std::uint32_t x = 0; x < image.width; ++x) {
        const std::size_t color = indices[std::size_t{y} * image.width + x];
        used[color] = true;
        columns[color * image.width + x] |= static_cast<std::uint8_t>(1u << (y - band));
      }
    bool first = true;
    for (std::size_t color = 0; color < colors; ++color) {
      if (!used[color]) continue;
      text += fmt::format("{}#{}", std::exchange(first, false) ? "" : "$", color);
      appendRuns(text, std::span(columns).subspan(color * image.width, image.width));
    }
  }
  return text +
         "\x1b\\\x1b"
         "8";
}

}  // namespace quintet::io
