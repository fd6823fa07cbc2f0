// SPDX-License-Identifier: Apache-2.0
// The hit that the oracle (csg_oracle.h, double precision on the host) computes for a probe's ray, and the tolerances.
#ifndef QUINTET_TESTS_GPU_PROCEDURAL_EXPECTATION_H
#define QUINTET_TESTS_GPU_PROCEDURAL_EXPECTATION_H

#include <algorithm>
#include <optional>

#include <gtest/gtest.h>

#include "../../unit/scene/csg_oracle.h"
#include "probe.h"

namespace quintet::test {

using oracle::dmat4;
using oracle::dvec3;

struct Expected {
  std::optional<oracle::Crossing> hit;
  bool doubtful = false;  // a ray that differs by a few rounding errors has a different hit
};

inline oracle::Ray toObject(const ProbeRay& ray, const mat4& worldFromObject) {
  const dmat4 objectFromWorld = glm::inverse(dmat4(worldFromObject));
  return {dvec3(objectFromWorld * glm::dvec4(dvec3(ray.origin), 1.0)),
          dvec3(objectFromWorld * glm::dvec4(dvec3(ray.direction), 0.0))};
}

// `crossingsOf`: oracle::Crossings of an object-space ray.
template <class CrossingsOf>
Expected expectHit(const CrossingsOf& crossingsOf, const ProbeRay& ray, const mat4& worldFromObject) {
  const oracle::Ray local = toObject(ray, worldFromObject);
  Expected result{oracle::firstHit(crossingsOf(local), ray.tmin, ray.tmax), false};
  const double e = 4e-6 * (glm::length(local.origin) + 4.0);
  for (int k = 0; k < 6 && !result.doubtful; ++k) {
    dvec3 by(0.0);
    by[k / 2] = k % 2 ? e : -e;
    const auto moved =
        oracle::firstHit(crossingsOf(oracle::Ray{local.origin + by, local.direction}), ray.tmin, ray.tmax);
    result.doubtful = moved.has_value() != result.hit.has_value() ||
                      (moved && (moved->entering != result.hit->entering || moved->primitive != result.hit->primitive ||
                                 glm::dot(moved->normal, result.hit->normal) < 0.99 ||
                                 std::abs(moved->t - result.hit->t) * glm::length(local.direction) > 0.1));
  }
  return result;
}

inline void compareHit(const ProbeHit& hit, const ProbeRay& ray, const Expected& expected,
                       const mat4& worldFromObject) {
  ASSERT_EQ(hit.t >= 0.0f, expected.hit.has_value())
      << "t " << hit.t << " instead of " << (expected.hit ? expected.hit->t : -1.0);
  EXPECT_EQ(hit.visible, !expected.hit.has_value());
  if (!expected.hit) return;
  // Rounding errors are proportional to a length. For grazing rays, the error of t is larger by 1 / cosine.
  const dvec3 d(ray.direction);
  const dvec3 normal =
      glm::normalize(glm::transpose(glm::inverse(oracle::dmat3(dmat4(worldFromObject)))) * expected.hit->normal);
  const double length = glm::length(d), cosine = std::abs(glm::dot(normal, d)) / length;
  const double scale =
      glm::length(dvec3(ray.origin)) + std::abs(expected.hit->t) * length + glm::length(dvec3(hit.position));
  EXPECT_NEAR(hit.t, expected.hit->t, 4e-6 * scale / length / std::max(cosine, 0.01));
  EXPECT_EQ(hit.leaf, expected.hit->primitive);
  EXPECT_EQ(hit.front, expected.hit->entering);
  EXPECT_EQ(hit.flipped, expected.hit->flipped);
  // The probe's normal is on the side of the ray; the oracle's normal points out of the tree.
  EXPECT_GT(glm::dot(dvec3(hit.normal), hit.front ? normal : -normal), 0.999);
  EXPECT_NEAR(glm::length(hit.normal), 1.0f, 1e-5f);
  const dvec3 point = dvec3(ray.origin) + static_cast<double>(hit.t) * d;
  EXPECT_LT(glm::length(dvec3(hit.position) - point), 1e-5 * scale / std::max(cosine, 0.01));
}

}  // namespace quintet::test
#endif
