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

// As the image: linear premultiplied RGBA floats of this size.
io::Image matching(const io::Image& reference, const io::Image& image) {
  io::Image result = io::toPremultiplied(io::toChannels(reference, 4));
  if (result.width != image.width || result.height != image.height)
    result = io::toPremultiplied(io::resizeBox(result, image.width, image.height));
  return result;
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
         range.most == other.range.most && range.logarithmic == other.range.logarithmic && compare == other.compare;
}

Display makeDisplay(const io::Image& image, const io::Image* reference, const DisplaySettings& settings) {
  Display result;
  result.histogram = makeHistogram(image);
  const CompareMode compare = reference ? settings.compare : CompareMode::off;
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
  if (compare == CompareMode::off) {
    result.image = shown(image);
    return result;
  }
  const io::Image other = matching(*reference, image);
  if (compare == CompareMode::split) {
    result.image = shown(image);
    result.reference = shown(other);
    return result;
  }
  if (compare == CompareMode::difference) {
    const std::vector<float> errors = differences(image, other);
    const FalseColorRange range{0.0, settings.range.most, false};
    result.image = colored(image, [&](const float*, std::size_t i) { return range.position(errors[i]); });
    result.error = meanOf(errors);
    return result;
  }
  const io::Image map = io::flipMap(displayedLight(image, settings), displayedLight(other, settings));
  const auto errors = map.samples<float>();
  result.image = colored(image, [&](const float*, std::size_t i) { return static_cast<double>(errors[i]); });
  result.error = meanOf({errors.begin(), errors.end()});
  return result;
}

}  // namespace quintet::viewer
