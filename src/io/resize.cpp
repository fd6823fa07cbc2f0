// Box filter: first along the rows, then along the columns; each output pixel is the mean of the input's
// area under it.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "io/image.h"

namespace quintet::io {
namespace {

// Output pixel i covers input pixels first[i] … with weights that sum to 1.
struct Taps {
  std::size_t first;
  std::vector<float> weights;
};

std::vector<Taps> makeTaps(std::uint32_t from, std::uint32_t to) {
  std::vector<Taps> taps(to);
  for (std::uint32_t i = 0; i < to; ++i) {
    // In units of 1/to of an input pixel everything is an integer: no pixel is lost to rounding.
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

Image resizeBox(const Image& image, std::uint32_t width, std::uint32_t height) {
  if (width == 0 || height == 0 || image.empty()) throw UsageError("an image cannot be resized from or to nothing");
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

}  // namespace quintet::io
