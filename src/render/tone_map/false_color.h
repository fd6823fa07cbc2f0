// SPDX-License-Identifier: Apache-2.0
// False colors for outputs of one quantity, such as heat maps: the color map viridis, and a legend.
#ifndef QUINTET_RENDER_TONE_MAP_FALSE_COLOR_H
#define QUINTET_RENDER_TONE_MAP_FALSE_COLOR_H

#include <cstdint>

#include "base/math.h"
#include "io/image.h"

namespace quintet::render {

// The color map viridis from 0 (dark violet) to 1 (yellow), sRGB-encoded. Perceptually uniform, also for readers with
// red-green color blindness and in gray. NaN gives the color of 0.
vec3 viridis(float t);

struct FalseColorScale {
  float maximum = 1.0f;   // the value that has the color viridis(1); 0 if no value is positive
  bool exceeded = false;  // there are larger finite values, with the same color
};

// The scale for the first channel: its largest finite value, or its 99th percentile if that is less than half of it, so that a
// few outliers do not darken all other pixels. Times 2^-exposure, but finite.
FalseColorScale falseColorScale(const io::Image& image, float exposure);

// Rows that FalseColorOptions::legend adds below an image.
inline constexpr std::uint32_t kLegendRows = 24;

struct FalseColorOptions {
  FalseColorScale scale{};
  bool legend = true;  // adds kLegendRows below the image: the color map, and the values 0, half and maximum
  unsigned bits = 8;   // or 16, per channel
};

// Colors the first channel of linear float pixels. Returns sRGB with 3 channels. Values that are not finite are magenta.
io::Image falseColor(const io::Image& image, const FalseColorOptions& options);

}  // namespace quintet::render
#endif
