// SPDX-License-Identifier: Apache-2.0
// Properties of points in the unit square, for the tests of both samplers.
#ifndef QUINTET_TESTS_GPU_SAMPLING_NETS_H
#define QUINTET_TESTS_GPU_SAMPLING_NETS_H

#include <bit>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/math.h"

namespace quintet::test {

// Returns whether, for every i, each of the 2^k boxes of 2^-i x 2^-j, i + j = k, contains exactly one of 2^k points.
inline bool isNet(const std::vector<vec2>& points) {
  const int k = std::countr_zero(points.size());
  for (int i = 0; i <= k; ++i) {
    std::vector<bool> seen(points.size(), false);
    for (const vec2& p : points) {
      const auto x = static_cast<std::size_t>(p.x * std::ldexp(1.0f, i));
      const auto y = static_cast<std::size_t>(p.y * std::ldexp(1.0f, k - i));
      const std::size_t box = (x << (k - i)) + y;
      if (seen[box]) return false;
      seen[box] = true;
    }
  }
  return true;
}

}  // namespace quintet::test
#endif
