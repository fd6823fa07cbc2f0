// SPDX-License-Identifier: Apache-2.0
// Numbers as colors, with a legend.
#ifndef QUINTET_VIEWER_FALSE_COLOR_H
#define QUINTET_VIEWER_FALSE_COLOR_H

#include <string>
#include <vector>

#include "base/math.h"

namespace quintet::viewer {

// Which numbers the ends of the color map represent.
struct FalseColorRange {
  double least = 0.0;
  double most = 1.0;
  bool logarithmic = false;  // requires least > 0
  // The position of a number in the color map, [0,1]; NaN for NaN.
  double position(double value) const;
  double valueAt(double position) const;  // the inverse for positions in [0,1]
};

// render::viridis() at a position in [0,1]; NaN is magenta. sRGB-encoded, [0,1].
vec3 falseColor(double position);

struct LegendTick {
  double position = 0;  // [0,1]
  std::string label;
};
// About `count` round numbers within the range; powers of ten if it is logarithmic.
std::vector<LegendTick> legendTicks(const FalseColorRange& range, int count);

// A range with round ends that contains [least, most].
FalseColorRange roundRange(double least, double most);

}  // namespace quintet::viewer
#endif
