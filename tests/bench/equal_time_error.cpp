// SPDX-License-Identifier: Apache-2.0
#include "equal_time_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "io/compare.h"

namespace quintet::bench {
namespace {

io::Image linearRgb(const io::Image& image) { return io::toChannels(io::toPremultiplied(image), 3); }

double meanLuminance(const io::Image& rgb) {
  constexpr std::array<double, 3> kWeights{0.2126, 0.7152, 0.0722};
  double sum = 0;
  const std::span<const float> samples = rgb.samples<float>();
  for (std::size_t i = 0; i < samples.size(); ++i) sum += kWeights[i % 3] * samples[i];
  return sum / static_cast<double>(rgb.pixelCount());
}

io::Image exposed(io::Image rgb, float exposure) {
  for (float& v : rgb.samples<float>()) v = std::clamp(v * exposure, 0.0f, 1.0f);
  return rgb;
}

}  // namespace

ImageError imageError(const io::Image& image, const io::Image& reference, float exposure) {
  const io::Image a = linearRgb(image);
  const io::Image r = linearRgb(reference);
  if (a.width != r.width || a.height != r.height) throw UsageError("image and reference differ in size");
  const double level = meanLuminance(r);
  const double eps = 0.01 * level * level;
  std::vector<double> errors(a.pixelCount(), 0.0);
  for (std::size_t i = 0; i < a.sampleCount(); ++i) {
    const double reference64 = r.samples<float>()[i];
    const double difference = a.samples<float>()[i] - reference64;
    errors[i / 3] += difference * difference / (reference64 * reference64 + eps) / 3.0;
  }
  ImageError result;
  std::ranges::sort(errors);
  const std::size_t kept = errors.size() - errors.size() / 1000;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(kept);
  const double sum = std::accumulate(errors.begin(), middle, 0.0);
  result.trimmed = sum / static_cast<double>(kept);
  result.relMse = std::accumulate(middle, errors.end(), sum) / static_cast<double>(errors.size());
  result.mean = level > 0 ? meanLuminance(a) / level : 1.0;
  const io::Image map = io::flipMap(exposed(a, exposure), exposed(r, exposure));
  for (const float v : map.samples<float>()) result.flip += v / static_cast<double>(map.pixelCount());
  return result;
}

float middleExposure(const io::Image& reference) {
  const double level = meanLuminance(linearRgb(reference));
  return level > 0 ? static_cast<float>(0.25 / level) : 1.0f;
}

io::Image sideBySide(const io::Image& a, const io::Image& b, const io::Image& reference, float exposure) {
  constexpr std::uint32_t kGap = 4;
  io::Image result = io::makeImage(3 * a.width + 2 * kGap, a.height, 3, io::PixelType::u8, io::ColorEncoding::sRgb);
  std::uint32_t left = 0;
  for (const io::Image* part : std::array{&a, &b, &reference}) {
    const io::Image bytes = io::toSrgb8(exposed(linearRgb(*part), exposure));
    for (std::uint32_t y = 0; y < bytes.height; ++y)
      for (std::uint32_t x = 0; x < bytes.width; ++x)
        std::ranges::copy(bytes.pixel<std::uint8_t>(x, y), result.pixel<std::uint8_t>(left + x, y).begin());
    left += a.width + kGap;
  }
  return result;
}

Estimate estimate(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  Estimate result{std::accumulate(values.begin(), values.end(), 0.0) / n, 0.0};
  double squares = 0;
  for (const double v : values) squares += (v - result.mean) * (v - result.mean);
  if (values.size() > 1) result.error = std::sqrt(squares / (n - 1.0) / n);
  return result;
}

}  // namespace quintet::bench
