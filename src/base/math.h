// SPDX-License-Identifier: Apache-2.0
// The glm configuration of the project, and bounding boxes. Vectors are columns, matrices are column-major, frames are
// right-handed, and the name of a transform has both spaces (worldFromObject).
#ifndef QUINTET_BASE_MATH_H
#define QUINTET_BASE_MATH_H

#ifdef GLM_VERSION
#error "include base/math.h instead of glm: the types of glm depend on this configuration"
#endif
#define GLM_FORCE_DEPTH_ZERO_TO_ONE
#define GLM_FORCE_SIZE_T_LENGTH
#define GLM_ENABLE_EXPERIMENTAL
#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/packing.hpp>
#include <glm/gtc/quaternion.hpp>

#include <cmath>
#include <cstdint>
#include <limits>

namespace quintet {

using glm::mat3;
using glm::mat4;
using glm::quat;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;

// Returns the smallest multiple of `alignment` (at least 1) that is not less than `value`.
constexpr std::uint64_t alignUp(std::uint64_t value, std::uint64_t alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

inline constexpr float kPi = 3.14159265358979323846f;

// Axis-aligned bounding box. The default is empty (min > max), the neutral element of `extend`.
struct Bounds3 {
  vec3 min{std::numeric_limits<float>::infinity()};
  vec3 max{-std::numeric_limits<float>::infinity()};

  bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  vec3 center() const { return 0.5f * min + 0.5f * max; }
  vec3 extent() const { return max - min; }
  void extend(const vec3& p) { min = glm::min(min, p), max = glm::max(max, p); }
  void extend(const Bounds3& b) { min = glm::min(min, b.min), max = glm::max(max, b.max); }
  // Surface area; 0 if empty.
  float area() const {
    if (empty()) return 0.0f;
    const vec3 e = extent();
    return 2.0f * (e.x * e.y + e.y * e.z + e.z * e.x);
  }
  // Returns the bounds of the eight transformed corners.
  Bounds3 transformed(const mat4& m) const {
    Bounds3 result;
    if (empty()) return result;
    for (int i = 0; i < 8; ++i) {
      const vec3 corner{i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z};
      result.extend(vec3(m * vec4(corner, 1.0f)));
    }
    return result;
  }
};

inline bool isFinite(const vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
inline bool isFinite(const vec4& v) { return isFinite(vec3(v)) && std::isfinite(v.w); }
inline bool isFinite(const mat4& m) { return isFinite(m[0]) && isFinite(m[1]) && isFinite(m[2]) && isFinite(m[3]); }

}  // namespace quintet
#endif
