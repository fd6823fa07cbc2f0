// SPDX-License-Identifier: Apache-2.0
#include "io/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "io/color.h"
#include "io/flip.h"

namespace quintet::io {
namespace {

// Below this range the filter is a single pixel, above it is larger than any image.
constexpr float kMinPixelsPerDegree = 1.0f;
constexpr float kMaxPixelsPerDegree = 1000.0f;

void checkInputs(const Image& a, const Image& b, float pixelsPerDegree) {
  if (a.pixelCount() == 0 || b.pixelCount() == 0) throw UsageError("an image without pixels cannot be compared");
  if (a.width != b.width || a.height != b.height)
    throw UsageError(fmt::format("images of different sizes cannot be compared: {} x {} and {} x {} pixels", a.width,
                                 a.height, b.width, b.height));
  if (!(pixelsPerDegree >= kMinPixelsPerDegree && pixelsPerDegree <= kMaxPixelsPerDegree))
    throw UsageError(fmt::format("FLIP supports {} to {} pixels per degree, not {}", kMinPixelsPerDegree,
                                 kMaxPixelsPerDegree, pixelsPerDegree));
}

// Returns linear RGB over black.
Image overBlack(const Image& image) { return toChannels(toPremultiplied(image), 3); }

Image clampToDisplay(Image image) {
  for (float& value : image.samples<float>()) value = value > 0.0f ? std::min(value, 1.0f) : 0.0f;  // NaN becomes 0
  return image;
}

void compareLinear(const Image& a, const Image& b, Comparison& result) {
  const std::span<const float> samplesA = a.samples<float>();
  const std::span<const float> samplesB = b.samples<float>();
  double squares = 0.0;
  double relative = 0.0;
  for (std::size_t pixel = 0; pixel < samplesA.size(); pixel += 3) {
    const auto finite = [&](float v) { return std::isfinite(v); };
    if (!std::ranges::all_of(samplesA.subspan(pixel, 3), finite) ||
        !std::ranges::all_of(samplesB.subspan(pixel, 3), finite)) {
      ++result.nonFinitePixels;
      continue;
    }
    for (std::size_t i = pixel; i < pixel + 3; ++i) {
      const double reference = samplesB[i];
      const double difference = samplesA[i] - reference;
      squares += difference * difference;
      relative += difference * difference / (reference * reference + 0.01);
    }
  }
  const std::size_t count = samplesA.size() - 3 * result.nonFinitePixels;
  if (count == 0) return;
  result.rmse = std::sqrt(squares / static_cast<double>(count));
  result.relMse = relative / static_cast<double>(count);
}

void compareBytes(const Image& a, const Image& b, Comparison& result) {
  const std::span<const std::uint8_t> samplesA = a.samples<std::uint8_t>();
  const std::span<const std::uint8_t> samplesB = b.samples<std::uint8_t>();
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < samplesA.size(); ++i) {
    const double difference = std::abs(samplesA[i] - samplesB[i]);
    sum += difference;
    squares += difference * difference;
    result.max8 = std::max(result.max8, difference);
  }
  const auto count = static_cast<double>(samplesA.size());
  result.mae8 = sum / count;
  result.psnr =
      squares > 0.0 ? 10.0 * std::log10(255.0 * 255.0 * count / squares) : std::numeric_limits<double>::infinity();
}

float alphaAt(const Image& linear, std::size_t pixel) {
  return linear.hasAlpha() ? linear.samples<float>()[(pixel + 1) * linear.channels - 1] : 1.0f;
}

double meanAlphaDifference(const Image& a, const Image& b) {
  if (!a.hasAlpha() && !b.hasAlpha()) return 0.0;
  const Image linearA = toFloat(a);
  const Image linearB = toFloat(b);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixelCount(); ++i)
    sum += std::abs(byteFromUnit(alphaAt(linearA, i)) - byteFromUnit(alphaAt(linearB, i)));
  return sum / static_cast<double>(a.pixelCount());
}

double meanOf(const Image& map) {
  double sum = 0.0;
  for (const float value : map.samples<float>()) sum += value;
  return sum / static_cast<double>(map.sampleCount());
}

// Björn Ottosson, "A perceptual color space for image processing" (2020), https://bottosson.github.io/posts/oklab/
std::array<float, 3> linearFromOklab(float lightness, float a, float b) {
  const auto cube = [](float v) { return v * v * v; };
  const float l = cube(lightness + 0.3963377774f * a + 0.2158037573f * b);
  const float m = cube(lightness - 0.1055613458f * a - 0.0638541728f * b);
  const float s = cube(lightness - 0.0894841775f * a - 1.2914855480f * b);
  return {4.0767416621f * l - 3.3077115913f * m + 0.2309699292f * s,
          -1.2684380046f * l + 2.6097574011f * m - 0.3413193965f * s,
          -0.0041960863f * l - 0.7034186147f * m + 1.7076147010f * s};
}

// The lightness increases with t; the hue goes from blue-violet over red to yellow.
std::array<std::uint8_t, 3> mapColor(float t) {
  const float hue = (290.0f + 175.0f * std::pow(t, 1.5f)) * std::numbers::pi_v<float> / 180.0f;
  const float chroma = 0.18f * std::sin(std::numbers::pi_v<float> * std::pow(t, 0.8f)) + 0.08f * t;
  const std::array<float, 3> rgb = linearFromOklab(0.98f * t, chroma * std::cos(hue), chroma * std::sin(hue));
  std::array<std::uint8_t, 3> bytes;
  for (std::size_t c = 0; c < 3; ++c) bytes[c] = byteFromUnit(srgbFromLinear(rgb[c]));
  return bytes;
}

}  // namespace

Image flipMap(const Image& a, const Image& b, float pixelsPerDegree) {
  checkInputs(a, b, pixelsPerDegree);
  return flipOfDisplayable(clampToDisplay(overBlack(a)), clampToDisplay(overBlack(b)), pixelsPerDegree);
}

Comparison compareImages(const Image& a, const Image& b, float pixelsPerDegree) {
  checkInputs(a, b, pixelsPerDegree);
  Comparison result;
  Image linearA = overBlack(a);
  Image linearB = overBlack(b);
  compareLinear(linearA, linearB, result);
  compareBytes(toSrgb8(linearA), toSrgb8(linearB), result);
  result.alphaMae8 = meanAlphaDifference(a, b);
  result.flipMap =
      flipOfDisplayable(clampToDisplay(std::move(linearA)), clampToDisplay(std::move(linearB)), pixelsPerDegree);
  result.flip = meanOf(result.flipMap);
  return result;
}

Image colorMap(const Image& map) {
  const Image values = toChannels(toFloat(map), 1);
  std::array<std::array<std::uint8_t, 3>, 256> table;
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = mapColor(static_cast<float>(i) / 255.0f);
  Image image = makeImage(map.width, map.height, 3, PixelType::u8, ColorEncoding::sRgb);
  const std::span<std::uint8_t> out = image.samples<std::uint8_t>();
  for (std::size_t i = 0; i < values.pixelCount(); ++i)
    std::ranges::copy(table[byteFromUnit(values.samples<float>()[i])],
                      out.begin() + static_cast<std::ptrdiff_t>(3 * i));
  return image;
}

}  // namespace quintet::io
