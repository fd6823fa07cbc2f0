// SPDX-License-Identifier: Apache-2.0
#include "viewer/display.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/parallel.h"
#include "io/color.h"
#include "io/compare.h"
#include "render/tone_map/false_color.h"

namespace quintet::viewer {
namespace {

DisplayPixels pixelsOf(const io::Image& rgba) {
  assert(rgba.channels == 4 && rgba.type == io::PixelType::u8);
  return {{rgba.width, rgba.height}, std::make_shared<const std::vector<std::byte>>(rgba.data)};
}

double valueOf(const float* rgba, Channel channel) {
  switch (channel) {
    case Channel::luminance: return 0.2126 * rgba[0] + 0.7152 * rgba[1] + 0.0722 * rgba[2];
    case Channel::red: return rgba[0];
    case Channel::green: return rgba[1];
    case Channel::blue: return rgba[2];
    case Channel::alpha: return rgba[3];
  }
  return 0.0;
}

// Colors of the pixels at the positions of the color map that `position(rgba, index)` returns.
template <class Position>
DisplayPixels colored(const io::Image& image, const Position& position) {
  auto bytes = std::make_shared<std::vector<std::byte>>(image.pixelCount() * 4);
  const float* samples = image.samples<float>().data();
  parallelRanges(image.pixelCount(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const vec3 color = falseColor(position(samples + 4 * i, i));
      for (std::size_t c = 0; c < 3; ++c)
        (*bytes)[4 * i + c] = std::byte{io::byteFromUnit(color[static_cast<glm::length_t>(c)])};
      (*bytes)[4 * i + 3] = std::byte{255};
    }
  });
  return {{image.width, image.height}, std::move(bytes)};
}

DisplayPixels toneMapped(const io::Image& image, const DisplaySettings& settings) {
  return pixelsOf(render::toDisplay(image, settings.toneMap, static_cast<float>(settings.exposure), false));
}

bool isFinitePixel(const float* rgba) {
  return std::isfinite(rgba[0]) && std::isfinite(rgba[1]) && std::isfinite(rgba[2]);
}

std::vector<uvec2> findNotFinite(const io::Image& image) {
  std::vector<uvec2> found;
  const float* samples = image.samples<float>().data();
  for (std::size_t i = 0; i < image.pixelCount() && found.size() < kMaxNotFinite; ++i)
    if (!isFinitePixel(samples + 4 * i)) found.push_back({i % image.width, i / image.width});
  return found;
}

// Magenta, as the false color of NaN.
DisplayPixels marked(const DisplayPixels& pixels, const io::Image& image) {
  auto bytes = std::make_shared<std::vector<std::byte>>(*pixels.bytes);
  const float* samples = image.samples<float>().data();
  for (std::size_t i = 0; i < image.pixelCount(); ++i) {
    if (isFinitePixel(samples + 4 * i)) continue;
    for (const std::size_t c : {0, 2, 3}) (*bytes)[4 * i + c] = std::byte{255};
    (*bytes)[4 * i + 1] = std::byte{0};
  }
  return {pixels.size, std::move(bytes)};
}

struct FittedReference {
  io::Image image;      // linear premultiplied RGBA floats, of the size of the rendered image
  double coverage = 1;  // share of the pixels that the reference covers, (0,1]
};

// Scales the reference until it fits, and centers it. Pixels beside it, of a reference with another aspect ratio, are
// those of `background`, or transparent.
FittedReference fitted(const io::Image& reference, const io::Image& image, const io::Image* background) {
  io::Image scaled = io::toPremultiplied(io::toChannels(reference, 4));
  if (scaled.width == image.width && scaled.height == image.height) return {std::move(scaled), 1.0};
  const auto side = [](std::uint64_t full, std::uint64_t part, std::uint64_t whole) {
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>((full * part + whole / 2) / whole, 1, full));
  };
  const bool isWider = std::uint64_t{scaled.width} * image.height >= std::uint64_t{image.width} * scaled.height;
  const uvec2 size = isWider
                         ? uvec2(image.width, std::min(image.height, side(image.width, scaled.height, scaled.width)))
                         : uvec2(std::min(image.width, side(image.height, scaled.width, scaled.height)), image.height);
  scaled = io::toPremultiplied(io::resizeBox(scaled, size.x, size.y));
  if (size == uvec2(image.width, image.height)) return {std::move(scaled), 1.0};
  io::Image result =
      background ? *background : io::makeImage(image.width, image.height, 4, io::PixelType::f32, image.encoding);
  const uvec2 corner = (uvec2(image.width, image.height) - size) / 2u;
  const float* from = scaled.samples<float>().data();
  float* to = result.samples<float>().data();
  for (std::uint32_t y = 0; y < size.y; ++y)
    std::copy_n(from + std::size_t{4} * y * size.x, std::size_t{4} * size.x,
                to + 4 * (std::size_t{corner.y + y} * image.width + corner.x));
  const double covered = static_cast<double>(size.x) * size.y;
  return {std::move(result), covered / static_cast<double>(image.pixelCount())};
}

// The display values as linear light, for FLIP.
io::Image displayedLight(const io::Image& image, const DisplaySettings& settings) {
  return io::toFloat(render::toDisplay(image, settings.toneMap, static_cast<float>(settings.exposure), true));
}

double meanOf(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float value : values) sum += std::isfinite(value) ? value : 0.0;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

std::vector<float> differences(const io::Image& a, const io::Image& b) {
  std::vector<float> result(a.pixelCount());
  const float* x = a.samples<float>().data();
  const float* y = b.samples<float>().data();
  parallelRanges(result.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      float most = 0.0f;
      for (std::size_t c = 4 * i; c < 4 * i + 3; ++c) {
        const float difference = std::abs(x[c] - y[c]);
        most = std::isnan(difference) ? difference : std::max(most, difference);
      }
      result[i] = most;
    }
  });
  return result;
}

}  // namespace

std::string_view channelName(Channel channel) {
  switch (channel) {
    case Channel::luminance: return "Luminance";
    case Channel::red: return "Red";
    case Channel::green: return "Green";
    case Channel::blue: return "Blue";
    case Channel::alpha: return "Alpha";
  }
  return "";
}

bool DisplaySettings::operator==(const DisplaySettings& other) const {
  return exposure == other.exposure && toneMap == other.toneMap && heat == other.heat &&
         falseColor == other.falseColor && channel == other.channel && range.least == other.range.least &&
         range.most == other.range.most && range.logarithmic == other.range.logarithmic && compare == other.compare &&
         marksNotFinite == other.marksNotFinite;
}

Display makeDisplay(const io::Image& image, const io::Image* reference, const DisplaySettings& settings) {
  Display result;
  result.histogram = makeHistogram(image);
  if (result.histogram.notFinitePixels > 0) result.notFinite = findNotFinite(image);
  const CompareMode compare = reference ? settings.compare : CompareMode::off;
  if (compare != CompareMode::off) result.referenceSize = {reference->width, reference->height};
  const bool showsHeat = settings.heat && !settings.falseColor && compare <= CompareMode::split;
  const render::FalseColorScale scale =
      showsHeat ? render::falseColorScale(image, static_cast<float>(settings.exposure)) : render::FalseColorScale{};
  if (showsHeat) result.heatRange = FalseColorRange{0.0, scale.maximum, false};
  const auto shown = [&](const io::Image& shownImage) {
    if (showsHeat) return pixelsOf(io::toChannels(render::falseColor(shownImage, {scale, /*legend=*/false}), 4));
    if (!settings.falseColor) return toneMapped(shownImage, settings);
    return colored(shownImage, [&](const float* rgba, std::size_t) {
      return settings.range.position(valueOf(rgba, settings.channel));
    });
  };
  if (compare <= CompareMode::split) {
    result.image = shown(image);
    const bool hasSceneColors = !showsHeat && !settings.falseColor;  // else NaN has a color of its own
    if (settings.marksNotFinite && hasSceneColors && !result.notFinite.empty())
      result.image = marked(result.image, image);
  }
  if (compare == CompareMode::off) return result;
  if (compare == CompareMode::split) {
    result.reference = shown(fitted(*reference, image, nullptr).image);
    return result;
  }
  const auto [other, coverage] = fitted(*reference, image, &image);  // no difference beside the reference
  if (compare == CompareMode::difference) {
    const std::vector<float> errors = differences(image, other);
    const FalseColorRange range{0.0, settings.range.most, false};
    result.image = colored(image, [&](const float*, std::size_t i) { return range.position(errors[i]); });
    result.error = meanOf(errors) / coverage;
    return result;
  }
  const io::Image map = io::flipMap(displayedLight(image, settings), displayedLight(other, settings));
  const auto errors = map.samples<float>();
  result.image = colored(image, [&](const float*, std::size_t i) { return static_cast<double>(errors[i]); });
  result.error = meanOf({errors.begin(), errors.end()}) / coverage;
  return result;
}

}  // namespace quintet::viewer
