// SPDX-License-Identifier: Apache-2.0
#include "io/image.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <type_traits>

#include "base/error.h"
#include "base/parallel.h"
#include "io/color.h"

namespace quintet::io {
namespace {

// Luminance weights of Rec. ITU-R BT.709-6, item 3.2.
constexpr std::array<float, 3> kLuminance{0.2126f, 0.7152f, 0.0722f};

template <class T>
constexpr float kUnit = std::is_same_v<T, float> ? 1.0f
                                                 : static_cast<float>(std::is_same_v<T, std::uint8_t> ? 255 : 65535);

// Calls function(T{}), where T is the sample type.
template <class Function>
auto withType(PixelType type, Function&& function) {
  switch (type) {
    case PixelType::u8: return function(std::uint8_t{});
    case PixelType::u16: return function(std::uint16_t{});
    case PixelType::f32: break;
  }
  return function(float{});
}

template <class T>
T fromUnit(float value) {
  if constexpr (std::is_same_v<T, float>) return value;
  return static_cast<T>(!(value > 0.0f) ? 0.0f : value >= 1.0f ? kUnit<T> : value * kUnit<T> + 0.5f);
}

template <class T>
std::vector<float> colorTable(ColorEncoding encoding) {
  std::vector<float> table(static_cast<std::size_t>(kUnit<T>) + 1);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const float value = static_cast<float>(i) / kUnit<T>;
    table[i] = encoding == ColorEncoding::sRgb ? linearFromSrgb(value) : value;
  }
  return table;
}

template <class T>
void decodeSamples(const Image& image, std::span<float> out) {
  const std::span<const T> in = image.samples<T>();
  const std::uint32_t colors = image.colorChannels();
  const auto convert = [&](auto&& color) {
    for (std::size_t i = 0; i < in.size(); i += image.channels) {
      for (std::uint32_t c = 0; c < colors; ++c) out[i + c] = color(in[i + c]);
      if (image.hasAlpha()) out[i + colors] = static_cast<float>(in[i + colors]) / kUnit<T>;
    }
  };
  if constexpr (std::is_same_v<T, float>) {
    convert([&](float v) { return image.encoding == ColorEncoding::sRgb ? linearFromSrgb(v) : v; });
  } else {
    const std::vector<float> table = colorTable<T>(image.encoding);
    convert([&](T v) { return table[v]; });
  }
}

float luminance(std::span<const float> rgb) {
  return kLuminance[0] * rgb[0] + kLuminance[1] * rgb[1] + kLuminance[2] * rgb[2];
}

template <class T>
float encodedLuminance(const T* rgb, ColorEncoding encoding) {
  std::array<float, 3> value;
  for (std::size_t c = 0; c < 3; ++c) value[c] = static_cast<float>(rgb[c]) / kUnit<T>;
  if (encoding == ColorEncoding::linear) return luminance(value);
  for (float& v : value) v = linearFromSrgb(v);
  return srgbFromLinear(luminance(value));
}

// ---- resizeBox: first along the rows, then along the columns

// The input pixels from `first` on that an output pixel covers, with weights that sum to 1.
struct Taps {
  std::size_t first;
  std::vector<float> weights;
};

std::vector<Taps> makeTaps(std::uint32_t from, std::uint32_t to) {
  std::vector<Taps> taps(to);
  for (std::uint32_t i = 0; i < to; ++i) {
    // All positions are integers in units of 1/to of an input pixel, so rounding loses no pixel.
    const std::uint64_t begin = std::uint64_t{i} * from;
    const std::uint64_t end = begin + from;
    taps[i].first = begin / to;
    for (std::uint64_t p = taps[i].first; p * to < end; ++p) {
      const std::uint64_t overlap = std::min(end, (p + 1) * to) - std::max(begin, p * to);
      taps[i].weights.push_back(static_cast<float>(static_cast<double>(overlap) / from));
    }
  }
  return taps;
}

Image resizeRows(const Image& in, std::uint32_t width) {
  Image out = makeImage(width, in.height, in.channels, PixelType::f32, ColorEncoding::linear);
  const std::vector<Taps> taps = makeTaps(in.width, width);
  float* to = out.samples<float>().data();
  for (std::uint32_t y = 0; y < in.height; ++y) {
    const float* row = in.samples<float>().data() + static_cast<std::size_t>(y) * in.width * in.channels;
    for (const Taps& tap : taps) {
      const float* from = row + tap.first * in.channels;
      for (const float weight : tap.weights)
        for (std::uint32_t c = 0; c < in.channels; ++c) to[c] += weight * *from++;
      to += in.channels;
    }
  }
  return out;
}

Image resizeColumns(const Image& in, std::uint32_t height) {
  Image out = makeImage(in.width, height, in.channels, PixelType::f32, ColorEncoding::linear);
  const std::vector<Taps> taps = makeTaps(in.height, height);
  const std::size_t row = static_cast<std::size_t>(in.width) * in.channels;
  float* to = out.samples<float>().data();
  for (const Taps& tap : taps) {
    const float* from = in.samples<float>().data() + tap.first * row;
    for (const float weight : tap.weights)
      for (std::size_t i = 0; i < row; ++i) to[i] += weight * *from++;
    to += row;
  }
  return out;
}

}  // namespace

std::size_t bytesPerSample(PixelType type) {
  return withType(type, [](auto sample) { return sizeof sample; });
}

Image makeImage(std::uint32_t width, std::uint32_t height, std::uint32_t channels, PixelType type,
                ColorEncoding encoding) {
  assert(channels >= 1 && channels <= 4);
  Image image{width, height, channels, type, encoding, {}, false};
  image.data.resize(image.rowBytes() * height);
  return image;
}

Image toFloat(const Image& image) {
  if (image.type == PixelType::f32 && image.encoding == ColorEncoding::linear) return image;
  Image result = makeImage(image.width, image.height, image.channels, PixelType::f32, ColorEncoding::linear);
  result.premultiplied = image.premultiplied;
  withType(image.type, [&](auto sample) { decodeSamples<decltype(sample)>(image, result.samples<float>()); });
  return result;
}

Image decodePower(const Image& image, float gamma) {
  if (image.encoding == ColorEncoding::linear) return image;
  Image encoded = image;
  encoded.encoding = ColorEncoding::linear;  // so that toFloat() keeps the values
  Image result = toFloat(encoded);
  const std::span<float> samples = result.samples<float>();
  for (std::size_t i = 0; i < samples.size(); i += result.channels)
    for (std::uint32_t c = 0; c < result.colorChannels(); ++c) samples[i + c] = std::pow(samples[i + c], gamma);
  return result;
}

Image toSrgb8(const Image& image) {
  if (image.type == PixelType::u8 && image.encoding == ColorEncoding::sRgb && !image.premultiplied) return image;
  const Image linear = toFloat(image);
  Image result = makeImage(image.width, image.height, image.channels, PixelType::u8, ColorEncoding::sRgb);
  const std::span<const float> in = linear.samples<float>();
  const std::span<std::uint8_t> out = result.samples<std::uint8_t>();
  const std::uint32_t colors = image.colorChannels();
  const std::size_t row = static_cast<std::size_t>(image.width) * image.channels;
  parallelFor(image.height, [&](std::size_t y) {
    for (std::size_t i = y * row; i < (y + 1) * row; i += image.channels) {
      const float alpha = image.hasAlpha() ? in[i + colors] : 1.0f;
      const float scale = image.premultiplied && alpha > 0.0f ? 1.0f / alpha : 1.0f;
      for (std::uint32_t c = 0; c < colors; ++c) out[i + c] = byteFromUnit(srgbFromLinear(in[i + c] * scale));
      if (image.hasAlpha()) out[i + colors] = byteFromUnit(alpha);
    }
  });
  return result;
}

void writeChannels(const Image& image, std::uint32_t channels, std::uint32_t first, std::span<std::byte> rows) {
  const std::size_t rowBytes = std::size_t{image.width} * channels * bytesPerSample(image.type);
  assert(rows.size() % rowBytes == 0 && first + rows.size() / rowBytes <= image.height);
  if (image.channels == channels)
    return parallelCopy(rows.data(), std::span(image.data).subspan(first * rowBytes, rows.size()));
  const bool alphaOut = channels == 2 || channels == 4;
  const std::uint32_t colorsOut = channels <= 2 ? 1 : 3;
  withType(image.type, [&](auto sample) {
    using T = decltype(sample);
    const T one = fromUnit<T>(1.0f);
    parallelFor(rows.size() / rowBytes, [&](std::size_t y) {
      const T* in = image.samples<T>().data() + (first + y) * image.width * image.channels;
      T* out = reinterpret_cast<T*>(rows.data() + y * rowBytes);
      for (std::size_t x = 0; x < image.width; ++x, in += image.channels, out += channels) {
        const T alpha = image.hasAlpha() ? in[image.channels - 1] : one;
        if (colorsOut == 1 && image.colorChannels() == 3) {
          out[0] = fromUnit<T>(encodedLuminance(in, image.encoding));
        } else {
          for (std::uint32_t c = 0; c < colorsOut; ++c) out[c] = in[image.colorChannels() == 3 ? c : 0];
        }
        if (alphaOut) out[channels - 1] = alpha;
      }
    });
  });
}

Image toChannels(const Image& image, std::uint32_t channels) {
  if (image.channels == channels) return image;
  Image result = makeImage(image.width, image.height, channels, image.type, image.encoding);
  result.premultiplied = image.premultiplied && result.hasAlpha();
  writeChannels(image, channels, 0, result.data);
  return result;
}

Image toPremultiplied(const Image& image) {
  Image result = toFloat(image);
  if (!result.hasAlpha() || result.premultiplied) return result;
  result.premultiplied = true;
  const std::span<float> samples = result.samples<float>();
  for (std::size_t i = 0; i < samples.size(); i += result.channels)
    for (std::uint32_t c = 0; c < result.colorChannels(); ++c) samples[i + c] *= samples[i + result.channels - 1];
  return result;
}

Image resizeBox(const Image& image, std::uint32_t width, std::uint32_t height) {
  if (width == 0 || height == 0 || image.empty()) throw UsageError("an image cannot be resized from or to 0 pixels");
  Image result = resizeColumns(resizeRows(toPremultiplied(image), width), height);
  if (!result.hasAlpha()) return result;
  result.premultiplied = image.premultiplied;
  if (result.premultiplied) return result;
  const std::span<float> samples = result.samples<float>();
  for (std::size_t i = 0; i < samples.size(); i += result.channels) {
    const float alpha = samples[i + result.channels - 1];
    if (alpha > 0.0f)
      for (std::uint32_t c = 0; c < result.colorChannels(); ++c) samples[i + c] /= alpha;
  }
  return result;
}

void resizeToSmaller(Image& a, Image& b) {
  if (a.width == b.width && a.height == b.height) return;
  Image& larger = a.pixelCount() > b.pixelCount() ? a : b;
  const Image& smaller = &larger == &a ? b : a;
  larger = resizeBox(larger, smaller.width, smaller.height);
}

}  // namespace quintet::io
