// SPDX-License-Identifier: Apache-2.0
// Vectors, transforms and bounds of the public API: plain arrays without a math library.
#ifndef QUINTET_TYPES_H
#define QUINTET_TYPES_H

#include <array>
#include <cmath>
#include <cstdint>

namespace quintet {

using Float2 = std::array<float, 2>;
using Float3 = std::array<float, 3>;
using Float4 = std::array<float, 4>;
using UInt3 = std::array<std::uint32_t, 3>;

// An affine transform as the first three rows of a 4x4 matrix for column vectors: q = rows[i] · (p, 1). The layout is that
// of VkTransformMatrixKHR. The default is the identity.
struct Transform {
  std::array<Float4, 3> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  // Moves by `offset`.
  static Transform translation(Float3 offset) {
    return {{{{1, 0, 0, offset[0]}, {0, 1, 0, offset[1]}, {0, 0, 1, offset[2]}}}};
  }
  // Scales along the axes.
  static Transform scaling(Float3 factors) {
    return {{{{factors[0], 0, 0, 0}, {0, factors[1], 0, 0}, {0, 0, factors[2], 0}}}};
  }
  // Rotates by `angle` radians about `axis`, which has any length but 0, by the right-hand rule.
  static Transform rotation(Float3 axis, float angle) {
    const float length = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    const float x = axis[0] / length, y = axis[1] / length, z = axis[2] / length;
    const float c = std::cos(angle), s = std::sin(angle), d = 1 - c;
    return {{{{c + d * x * x, d * x * y - s * z, d * x * z + s * y, 0},
              {d * x * y + s * z, c + d * y * y, d * y * z - s * x, 0},
              {d * x * z - s * y, d * y * z + s * x, c + d * z * z, 0}}}};
  }
  // Applies `b` first.
  friend Transform operator*(const Transform& a, const Transform& b) {
    Transform result;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 4; ++j) {
        result.rows[i][j] = j == 3 ? a.rows[i][3] : 0;
        for (std::size_t k = 0; k < 3; ++k) result.rows[i][j] += a.rows[i][k] * b.rows[k][j];
      }
    return result;
  }
  bool operator==(const Transform&) const = default;
};

// An axis-aligned box. Empty if min > max in any direction.
struct Bounds {
  Float3 min{};
  Float3 max{};
  bool operator==(const Bounds&) const = default;
};

}  // namespace quintet
#endif
