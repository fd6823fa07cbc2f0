// SPDX-License-Identifier: Apache-2.0
#include "render/tone_map/false_color.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "io/color.h"

namespace quintet::render {
namespace {

// Every 10 % of the color map viridis of S. van der Walt and N. Smith (matplotlib 1.5, CC0). Linear interpolation in between
// differs by less than 0.02 from the whole table of 256 colors.
constexpr std::array<std::array<float, 3>, 11> kViridis{{{0.267004f, 0.004874f, 0.329415f},
                                                         {0.282623f, 0.140926f, 0.457517f},
                                                         {0.253935f, 0.265254f, 0.529983f},
                                                         {0.206756f, 0.371758f, 0.553117f},
                                                         {0.163625f, 0.471133f, 0.558148f},
                                                         {0.127568f, 0.566949f, 0.550556f},
                                                         {0.134692f, 0.658636f, 0.517649f},
                                                         {0.266941f, 0.748751f, 0.440573f},
                                                         {0.477504f, 0.821444f, 0.318195f},
                                                         {0.741388f, 0.873449f, 0.149561f},
                                                         {0.993248f, 0.906157f, 0.143936f}}};
const vec3 kNotFinite(1.0f, 0.0f, 1.0f);

// The legend, in pixels.
constexpr std::uint32_t kMargin = 4;
constexpr std::uint32_t kBarRows = 6;
constexpr std::uint32_t kGlyphRows = 7, kGlyphColumns = 5, kGlyphStep = 6;
const vec3 kBackground(0.08f), kForeground(0.95f);

// Glyphs of 5x7 pixels, one row per byte, the leftmost pixel in bit 4.
constexpr std::string_view kGlyphNames = "0123456789.e+->";
constexpr std::array<std::array<std::uint8_t, kGlyphRows>, kGlyphNames.size()> kGlyphs{{
    {0b01110, 0b10001, 0b10001, 0b10101, 0b10001, 0b10001, 0b01110},
    {0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110},
    {0b01110, 0b10001, 0b00001, 0b00110, 0b01000, 0b10000, 0b11111},
    {0b01110, 0b10001, 0b00001, 0b00110, 0b00001, 0b10001, 0b01110},
    {0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010},
    {0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110},
    {0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110},
    {0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b01000, 0b01000},
    {0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110},
    {0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100},
    {0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b01100, 0b01100},
    {0b00000, 0b00000, 0b01110, 0b10001, 0b11111, 0b10000, 0b01110},
    {0b00000, 0b00100, 0b00100, 0b11111, 0b00100, 0b00100, 0b00000},
    {0b00000, 0b00000, 0b00000, 0b11111, 0b00000, 0b00000, 0b00000},
    {0b01000, 0b00100, 0b00010, 0b00001, 0b00010, 0b00100, 0b01000},
}};

struct Canvas {
  std::uint32_t width = 0;
  std::vector<vec3> pixels;
  vec3& at(std::uint32_t x, std::uint32_t y) { return pixels[std::size_t{y} * width + x]; }
};

std::uint32_t textWidth(std::string_view text) { return static_cast<std::uint32_t>(text.size()) * kGlyphStep - 1; }

void drawText(Canvas& canvas, std::uint32_t x, std::uint32_t y, std::string_view text) {
  for (const char c : text) {
    const std::size_t glyph = kGlyphNames.find(c);
    for (std::uint32_t row = 0; row < kGlyphRows && glyph != kGlyphNames.npos; ++row)
      for (std::uint32_t column = 0; column < kGlyphColumns; ++column)
        if ((kGlyphs[glyph][row] >> (kGlyphColumns - 1 - column) & 1) != 0)
          canvas.at(x + column, y + row) = kForeground;
    x += kGlyphStep;
  }
}

// Draws the color bar and as many of the labels maximum, 0 and half as there is space for.
void drawLegend(Canvas& canvas, std::uint32_t top, const FalseColorScale& scale) {
  const std::uint32_t width = canvas.width;
  for (std::uint32_t y = 0; y < kLegendRows; ++y)
    for (std::uint32_t x = 0; x < width; ++x) canvas.at(x, top + y) = kBackground;
  if (width <= 2 * kMargin + 1) return;
  const std::uint32_t bar = width - 2 * kMargin;
  for (std::uint32_t y = 0; y < kBarRows; ++y)
    for (std::uint32_t x = 0; x < bar; ++x)
      canvas.at(kMargin + x, top + kMargin + y) = viridis(static_cast<float>(x) / static_cast<float>(bar - 1));

  const std::uint32_t y = top + kLegendRows - kMargin - kGlyphRows;
  const std::string zero = "0", half = fmt::format("{:.3g}", 0.5 * scale.maximum),
                    full = fmt::format("{}{:.3g}", scale.exceeded ? ">" : "", scale.maximum);
  if (textWidth(full) > bar) return;
  drawText(canvas, kMargin + bar - textWidth(full), y, full);
  const std::uint32_t ends = textWidth(zero) + textWidth(full) + kGlyphStep;
  if (ends > bar) return;
  drawText(canvas, kMargin, y, zero);
  const std::uint32_t begin = (width - std::min(width, textWidth(half))) / 2;
  const bool fits = begin > kMargin + textWidth(zero) + kGlyphStep &&
                    begin + textWidth(half) + kGlyphStep < kMargin + bar - textWidth(full);
  if (fits) drawText(canvas, begin, y, half);
}

template <class T>
io::Image encode(const Canvas& canvas) {
  constexpr io::PixelType kType = sizeof(T) == 2 ? io::PixelType::u16 : io::PixelType::u8;
  const auto height = static_cast<std::uint32_t>(canvas.pixels.size() / std::max(1u, canvas.width));
  io::Image result = io::makeImage(canvas.width, height, 3, kType, io::ColorEncoding::sRgb);
  const std::span<T> samples = result.samples<T>();
  for (std::size_t i = 0; i < canvas.pixels.size(); ++i)
    for (glm::length_t c = 0; c < 3; ++c)
      samples[3 * i + static_cast<std::size_t>(c)] = io::integerFromUnit<T>(canvas.pixels[i][c]);
  return result;
}

}  // namespace

vec3 viridis(float t) {
  const float position = (t > 0.0f ? std::min(t, 1.0f) : 0.0f) * static_cast<float>(kViridis.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(position), kViridis.size() - 2);
  const float fraction = position - static_cast<float>(i);
  const auto color = [&](std::size_t k) { return vec3(kViridis[k][0], kViridis[k][1], kViridis[k][2]); };
  return glm::mix(color(i), color(i + 1), fraction);
}

FalseColorScale falseColorScale(const io::Image& image, float exposure) {
  const std::span<const float> samples = image.samples<float>();
  std::vector<float> values;
  for (std::size_t i = 0; i < samples.size(); i += image.channels)
    if (std::isfinite(samples[i])) values.push_back(std::max(samples[i], 0.0f));
  if (values.empty()) return {0.0f, false};
  const float largest = *std::ranges::max_element(values);
  const auto percentile = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 99 / 100);
  std::ranges::nth_element(values, percentile);
  const float chosen = *percentile > 0.0f && *percentile < 0.5f * largest ? *percentile : largest;
  const float maximum = std::min(chosen * std::exp2(-exposure), std::numeric_limits<float>::max());
  return {maximum, maximum < largest};
}

io::Image falseColor(const io::Image& image, const FalseColorOptions& options) {
  const std::span<const float> values = image.samples<float>();
  Canvas canvas{image.width,
                std::vector<vec3>(std::size_t{image.width} * (image.height + (options.legend ? kLegendRows : 0)))};
  for (std::size_t i = 0; i < image.pixelCount(); ++i) {
    const float value = values[i * image.channels];
    canvas.pixels[i] = !std::isfinite(value)          ? kNotFinite
                       : options.scale.maximum > 0.0f ? viridis(value / options.scale.maximum)
                                                      : viridis(0.0f);
  }
  if (options.legend) drawLegend(canvas, image.height, options.scale);
  return options.bits == 16 ? encode<std::uint16_t>(canvas) : encode<std::uint8_t>(canvas);
}

}  // namespace quintet::render
