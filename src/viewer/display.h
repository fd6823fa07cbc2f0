// SPDX-License-Identifier: Apache-2.0
// From linear values to the bytes that the window shows: tone mapping, false color, and the comparison with a reference
// image.
#ifndef QUINTET_VIEWER_DISPLAY_H
#define QUINTET_VIEWER_DISPLAY_H

#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "io/image.h"
#include "render/tone_map/tone_map.h"
#include "viewer/false_color.h"
#include "viewer/histogram.h"

namespace quintet::viewer {

// Which number of a pixel false color shows.
enum class Channel { luminance, red, green, blue, alpha };
std::string_view channelName(Channel channel);

enum class CompareMode {
  off,
  split,       // the reference image to the right of a line
  difference,  // largest difference of a channel, linear values, as false color from 0 to DisplaySettings::range.most
  flip,        // FLIP error, as false color from 0 to 1
};

struct DisplaySettings {
  double exposure = 0;  // stops
  render::ToneMap toneMap = render::ToneMap::linear;
  bool heat = false;        // first channel in false colors, as render::falseColor() and a PNG show it; without toneMap
  bool falseColor = false;  // instead of `heat`
  Channel channel = Channel::luminance;
  FalseColorRange range;
  CompareMode compare = CompareMode::off;
  bool marksNotFinite = true;  // magenta instead of the color of a pixel that is not finite
  bool operator==(const DisplaySettings& other) const;
};

inline constexpr std::size_t kMaxNotFinite = 256;

// RGBA bytes, rows from the top.
struct DisplayPixels {
  uvec2 size{0};
  std::shared_ptr<const std::vector<std::byte>> bytes;
};

struct Display {
  DisplayPixels image;
  DisplayPixels reference;                   // with CompareMode::split, of the same size
  Histogram histogram;                       // of the linear image
  std::vector<uvec2> notFinite;              // pixels, row by row; at most kMaxNotFinite
  std::optional<FalseColorRange> heatRange;  // of the colors, with DisplaySettings::heat
  uvec2 referenceSize{0};                    // before it was scaled; with a reference that is compared
  std::optional<double> error;               // mean of the difference or of FLIP; with CompareMode::difference and flip
};

// `image`: linear premultiplied RGBA floats. `reference`: any image; null if there is none, and CompareMode is then
// ignored. A reference with a different size is scaled to fit, and centered. If its aspect ratio differs, the pixels beside it
// are transparent in DisplayPixels::reference, and do not count in `error`.
Display makeDisplay(const io::Image& image, const io::Image* reference, const DisplaySettings& settings);

}  // namespace quintet::viewer
#endif
