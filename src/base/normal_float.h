// SPDX-License-Identifier: Apache-2.0
// Numbers of files as floats, without loss of their meaning at the limits of float.
#ifndef QUINTET_BASE_NORMAL_FLOAT_H
#define QUINTET_BASE_NORMAL_FLOAT_H

#include <algorithm>
#include <cmath>
#include <limits>

namespace quintet {

// Returns the nearest float. A number that is not 0 does not become 0 or denormal, which devices can flush to 0, and a finite one
// not infinite.
inline float normalFloat(double value) {
  if (!(value < 0.0 || value > 0.0)) return static_cast<float>(value);
  constexpr double kSmallest = std::numeric_limits<float>::min(), kLargest = std::numeric_limits<float>::max();
  return static_cast<float>(std::copysign(std::clamp(std::abs(value), kSmallest, kLargest), value));
}

// The same for a distance above 0 without an upper limit: the largest float, and all above it, mean infinity.
inline float distanceOrInfinity(double value) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return value < kLargest ? normalFloat(value) : std::numeric_limits<float>::infinity();
}

}  // namespace quintet
#endif
