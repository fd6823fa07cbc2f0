// SPDX-License-Identifier: Apache-2.0
#include "scene/model/mesh_bounds.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"

namespace quintet::scene {
namespace {

// Sine of the angle between two edges below which a triangle has no area. The positions are not more precise.
constexpr double kLeastSine = 1e-7;

bool hasArea(const std::vector<vec3>& positions, const uvec3& t) {
  if (t.x == t.y || t.y == t.z || t.z == t.x) return false;
  const glm::dvec3 corner(positions[t.x]);
  const glm::dvec3 a = glm::dvec3(positions[t.y]) - corner, b = glm::dvec3(positions[t.z]) - corner;
  const glm::dvec3 n = glm::cross(a, b);
  return glm::dot(n, n) > kLeastSine * kLeastSine * glm::dot(a, a) * glm::dot(b, b);
}

}  // namespace

std::vector<std::uint8_t> visibleVertices(const Geometry& geometry) {
  std::vector<std::uint8_t> visible(geometry.positions.size(), 0);
  parallelRanges(geometry.triangles.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const uvec3& t = geometry.triangles[i];
      if (!hasArea(geometry.positions, t)) continue;
      for (glm::length_t c = 0; c < 3; ++c) std::atomic_ref(visible[t[c]]).store(1, std::memory_order_relaxed);
    }
  });
  if (std::ranges::find(visible, std::uint8_t{0}) == visible.end()) visible = {};
  return visible;
}

Bounds3 geometryBounds(const Geometry& geometry, const std::vector<std::uint8_t>& visible, const mat4& transform) {
  constexpr std::size_t kGrain = 65536;
  const std::vector<vec3>& points = geometry.positions;
  std::vector<Bounds3> parts((points.size() + kGrain - 1) / kGrain);
  parallelRanges(
      points.size(),
      [&](std::size_t first, std::size_t last) {
        Bounds3 part;
        for (std::size_t i = first; i < last; ++i)
          if (visible.empty() || visible[i] != 0) part.extend(vec3(transform * vec4(points[i], 1.0f)));
        parts[first / kGrain] = part;
      },
      kGrain);
  Bounds3 bounds;
  for (const Bounds3& part : parts) bounds.extend(part);
  return bounds;
}

Bounds3 meshBounds(const Mesh& mesh, const mat4& transform) {
  Bounds3 bounds;
  for (const Geometry& geometry : mesh.geometries)
    bounds.extend(geometryBounds(geometry, visibleVertices(geometry), transform));
  for (const PrimitiveSet& set : mesh.primitiveSets) bounds.extend(boundsOf(set, transform));
  return bounds;
}

}  // namespace quintet::scene
