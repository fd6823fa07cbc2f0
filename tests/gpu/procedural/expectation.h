// SPDX-License-Identifier: Apache-2.0
// The hit that the oracle (csg_oracle.h, double precision on the host) computes for a probe's ray, and the tolerances.
#ifndef QUINTET_TESTS_GPU_PROCEDURAL_EXPECTATION_H
#define QUINTET_TESTS_GPU_PROCEDURAL_EXPECTATION_H

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "../../unit/scene/csg_oracle.h"
#include "probe.h"

namespace quintet::test {

using oracle::dmat4;
using oracle::dvec3;

struct Expected {
  std::optional<oracle::Crossing> hit;
  std::string difference;  // of the probe's hit; empty if it agrees within the tolerances
  bool doubtful = false;   // it differs, but a ray that differs by a few rounding errors has a different hit, too
};

inline oracle::Ray toObject(const ProbeRay& ray, const mat4& worldFromObject) {
  const dmat4 objectFromWorld = glm::inverse(dmat4(worldFromObject));
  return {dvec3(objectFromWorld * glm::dvec4(dvec3(ray.origin), 1.0)),
          dvec3(objectFromWorld * glm::dvec4(dvec3(ray.direction), 0.0))};
}

// How the hit of the probe differs from that of the oracle; empty if it does not.
inline std::string differenceOf(const ProbeHit& hit, const ProbeRay& ray,
                                const std::optional<oracle::Crossing>& expected, const mat4& worldFromObject) {
  if ((hit.t >= 0.0f) != expected.has_value())
    return fmt::format("t {} instead of {}", hit.t, expected ? expected->t : -1.0);
  if (hit.visible == expected.has_value()) return fmt::format("visible {}", hit.visible);
  if (!expected) return {};
  // Rounding errors are proportional to a length. For grazing rays, the error of t is larger by 1 / cosine.
  const dvec3 d(ray.direction);
  const dvec3 normal =
      glm::normalize(glm::transpose(glm::inverse(oracle::dmat3(dmat4(worldFromObject)))) * expected->normal);
  const double length = glm::length(d), cosine = std::max(std::abs(glm::dot(normal, d)) / length, 0.01);
  const double scale =
      glm::length(dvec3(ray.origin)) + std::abs(expected->t) * length + glm::length(dvec3(hit.position));
  const double t = static_cast<double>(hit.t);
  if (!(std::abs(t - expected->t) <= 4e-6 * scale / length / cosine))
    return fmt::format("t {} instead of {}", t, expected->t);
  if (hit.leaf != expected->primitive) return fmt::format("leaf {} instead of {}", hit.leaf, expected->primitive);
  if (hit.front != expected->entering) return fmt::format("front {}", hit.front);
  if (hit.flipped != expected->flipped) return fmt::format("flipped {}", hit.flipped);
  // The probe's normal is on the side of the ray; the oracle's normal points out of the tree.
  const double along = glm::dot(dvec3(hit.normal), hit.front ? normal : -normal);
  if (!(along > 0.999)) return fmt::format("normal with the cosine {}", along);
  if (!(std::abs(glm::length(dvec3(hit.normal)) - 1.0) < 1e-5)) return "normal that is not normalized";
  const double apart = glm::length(dvec3(hit.position) - (dvec3(ray.origin) + t * d));
  if (!(apart < 1e-5 * scale / cosine)) return fmt::format("position {} beside the ray", apart);
  return {};
}

// Compares the hit of a probe. `crossingsOf`: oracle::Crossings of an object-space ray.
template <class CrossingsOf>
Expected expectHit(const CrossingsOf& crossingsOf, const ProbeHit& hit, const ProbeRay& ray,
                   const mat4& worldFromObject) {
  const oracle::Ray local = toObject(ray, worldFromObject);
  Expected result;
  result.hit = oracle::firstHit(crossingsOf(local), ray.tmin, ray.tmax);
  result.difference = differenceOf(hit, ray, result.hit, worldFromObject);
  if (result.difference.empty()) return result;
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

}  // namespace quintet::test
#endif
