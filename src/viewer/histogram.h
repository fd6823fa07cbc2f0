// SPDX-License-Identifier: Apache-2.0
// How often values occur in an image.
#ifndef QUINTET_VIEWER_HISTOGRAM_H
#define QUINTET_VIEWER_HISTOGRAM_H

#include <array>
#include <cstddef>
#include <cstdint>

#include "io/image.h"

namespace quintet::viewer {

inline constexpr std::size_t kHistogramBins = 128;

// Bins are equally wide in stops: bin i holds the values whose log2 is in
// [kFirstStop + i · kStopsPerBin, kFirstStop + (i + 1) · kStopsPerBin). Values below and above are in the first and the
// last bin.
struct Histogram {
  static constexpr double kFirstStop = -10.0, kLastStop = 6.0;
  static constexpr double kStopsPerBin = (kLastStop - kFirstStop) / kHistogramBins;
  using Counts = std::array<std::uint32_t, kHistogramBins>;

  std::array<Counts, 3> channels{};  // R, G, B
  Counts luminance{};                // Rec. 709
  // Of the luminance of all finite pixels; 0 if there are none.
  double least = 0, most = 0, mean = 0;
  std::uint64_t notFinitePixels = 0;
};

// `image`: linear RGBA floats. Runs on all cores.
Histogram makeHistogram(const io::Image& image);

}  // namespace quintet::viewer
#endif
