// SPDX-License-Identifier: Apache-2.0
// Solids on the host for the lessons with intersection shaders: the interval of a ray, and normals.
#ifndef QUINTET_TESTS_LESSON_SOLIDS_H
#define QUINTET_TESTS_LESSON_SOLIDS_H

#include <optional>

#include "lesson.h"

namespace quintet::test {

struct Interval {
  double in = 0;
  double out = 0;
};

inline std::optional<Interval> sphereInterval(const HostRay& ray, const dvec3& center, double radius) {
  const dvec3 o = ray.origin - center;
  const double a = glm::dot(ray.direction, ray.direction), b = glm::dot(o, ray.direction),
               c = glm::dot(o, o) - radius * radius;
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return {};
  return Interval{(-b - std::sqrt(discriminant)) / a, (-b + std::sqrt(discriminant)) / a};
}

inline std::optional<Interval> boxInterval(const HostRay& ray, const dvec3& low, const dvec3& high) {
  Interval result{-1e300, 1e300};
  for (int i = 0; i < 3; ++i) {
    const double t0 = (low[i] - ray.origin[i]) / ray.direction[i], t1 = (high[i] - ray.origin[i]) / ray.direction[i];
    result.in = std::max(result.in, std::min(t0, t1));
    result.out = std::min(result.out, std::max(t0, t1));
  }
  if (result.in > result.out) return {};
  return result;
}

// The ray in the object space of an instance; t stays the same.
inline HostRay toObject(const HostRay& ray, const mat4& worldFromObject) {
  const glm::dmat4 inverse = glm::inverse(glm::dmat4(worldFromObject));
  return {dvec3(inverse * glm::dvec4(ray.origin, 1)), dvec3(inverse * glm::dvec4(ray.direction, 0))};
}

inline dvec3 normalToWorld(const dvec3& normal, const mat4& worldFromObject) {
  return glm::normalize(glm::transpose(glm::inverse(dmat3(glm::dmat4(worldFromObject)))) * normal);
}

}  // namespace quintet::test
#endif
