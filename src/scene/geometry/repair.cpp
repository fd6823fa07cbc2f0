// SPDX-License-Identifier: Apache-2.0
#include "scene/geometry/repair.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"
#include "scene/model/limits.h"

namespace quintet::scene {
namespace {

// Scales by the largest component first, so that tiny and huge vectors neither underflow nor overflow. Returns false if
// v is zero or not finite.
bool normalize(vec3& v) {
  const float largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!isFinite(v) || !(largest > 0.0f)) return false;
  v /= largest;
  v /= glm::length(v);
  return true;
}

// Sum over the triangles around each vertex of the face normal, weighted by twice the area.
std::vector<vec3> faceNormalSums(const Geometry& geometry) {
  std::vector<vec3> sums(geometry.positions.size(), vec3(0.0f));
  for (const uvec3& t : geometry.triangles) {
    const vec3& p = geometry.positions[t.x];
    const vec3 n = glm::cross(geometry.positions[t.y] - p, geometry.positions[t.z] - p);
    if (!isFinite(n)) continue;
    for (std::size_t c = 0; c < 3; ++c) sums[t[c]] += n;
  }
  return sums;
}

// Number of elements for which `test` is true, on all cores. `test` can change the elements.
template <class T, class Test>
std::size_t countIf(std::vector<T>& values, const Test& test) {
  std::atomic<std::size_t> count = 0;
  parallelRanges(values.size(), [&](std::size_t first, std::size_t last) {
    std::size_t found = 0;
    for (std::size_t i = first; i < last; ++i) found += test(values[i]) ? 1 : 0;
    count += found;
  });
  return count;
}

}  // namespace

std::size_t dropNonFiniteTriangles(Geometry& geometry) {
  auto& positions = geometry.positions;
  if (countIf(positions, [](const vec3& p) { return !isWithinLimits(p); }) == 0) return 0;
  const auto good = std::ranges::find_if(positions, [](const vec3& p) { return isWithinLimits(p); });

  std::vector<uvec3> kept;
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < geometry.triangles.size(); ++i) {
    const uvec3& t = geometry.triangles[i];
    if (!isWithinLimits(positions[t.x]) || !isWithinLimits(positions[t.y]) || !isWithinLimits(positions[t.z])) continue;
    kept.push_back(t);
    numbers.push_back(geometry.fileTriangles.empty() ? i : geometry.fileTriangles[i]);
  }
  const vec3 replacement = good == positions.end() ? vec3(0.0f) : *good;
  for (vec3& p : positions)
    if (!isWithinLimits(p)) p = replacement;
  const std::size_t dropped = geometry.triangles.size() - kept.size();
  if (dropped > 0) geometry.fileTriangles = std::move(numbers);
  geometry.triangles = std::move(kept);
  return dropped;
}

void dropUnusedVertices(Geometry& geometry) {
  std::vector<std::uint32_t> newIndex(geometry.positions.size(), 0);
  parallelRanges(geometry.triangles.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        std::atomic_ref(newIndex[geometry.triangles[i][c]]).store(1, std::memory_order_relaxed);
  });
  const std::size_t used = countIf(newIndex, [](std::uint32_t index) { return index != 0; });
  if (4 * used >= 3 * newIndex.size()) return;

  const auto compact = [&](auto& values) {
    if (values.empty()) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < newIndex.size(); ++i)
      if (newIndex[i] != 0) values[kept++] = values[i];
    values.resize(kept);
    values.shrink_to_fit();
  };
  compact(geometry.positions);
  compact(geometry.normals);
  compact(geometry.tangents);
  compact(geometry.colors);
  compact(geometry.fileVertices);
  for (auto& set : geometry.uvs) compact(set);
  std::uint32_t next = 0;
  for (std::uint32_t& index : newIndex) index = index != 0 ? next++ : 0;
  for (uvec3& t : geometry.triangles) t = {newIndex[t.x], newIndex[t.y], newIndex[t.z]};
}

std::size_t repairNormals(Geometry& geometry) {
  // normalize() does not change invalid normals, so that the second pass finds them.
  if (countIf(geometry.normals, [](vec3& n) { return !normalize(n); }) == 0) return 0;
  std::vector<std::size_t> broken;
  for (std::size_t i = 0; i < geometry.normals.size(); ++i)
    if (vec3 n = geometry.normals[i]; !normalize(n)) broken.push_back(i);
  const std::vector<vec3> sums = faceNormalSums(geometry);
  for (const std::size_t i : broken) {
    geometry.normals[i] = sums[i];
    if (!normalize(geometry.normals[i])) geometry.normals[i] = vec3(0.0f, 1.0f, 0.0f);
  }
  return broken.size();
}

std::size_t repairTangents(Geometry& geometry) {
  std::atomic<std::size_t> repaired = 0;
  parallelRanges(geometry.tangents.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      vec3 t(geometry.tangents[i]);
      const float w = geometry.tangents[i].w < 0.0f ? -1.0f : 1.0f;
      if (!normalize(t)) {
        t = anyPerpendicular(geometry.normals[i]);
        ++repaired;
      }
      geometry.tangents[i] = vec4(t, w);
    }
  });
  return repaired;
}

std::size_t repairUvsAndColors(Geometry& geometry) {
  std::size_t repaired = 0;
  for (auto& set : geometry.uvs) {
    repaired += countIf(set, [](vec2& uv) {
      const bool finite = std::isfinite(uv.x) && std::isfinite(uv.y);
      if (!finite) uv = vec2(0.0f);
      return !finite;
    });
  }
  repaired += countIf(geometry.colors, [](vec4& color) {
    const bool finite = isFinite(vec3(color)) && std::isfinite(color.w);
    color = finite ? glm::max(color, vec4(0.0f)) : vec4(1.0f);
    color.w = std::min(color.w, 1.0f);
    return !finite;
  });
  return repaired;
}

vec3 anyPerpendicular(const vec3& n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  return {1.0f + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x};
}

vec3 directionOr(const vec3& v, const vec3& fallback) {
  const float length = glm::length(v);
  return std::isfinite(length) && length > 0.0f ? v / length : fallback;
}

mat4 rigidFrame(const mat4& m) {
  const vec3 z = directionOr(vec3(m[2]), vec3(0, 0, 1));
  vec3 x = glm::cross(directionOr(vec3(m[1]), vec3(0, 1, 0)), z);
  x = glm::length(x) > 1e-4f ? glm::normalize(x) : anyPerpendicular(z);
  return {vec4(x, 0.0f), vec4(glm::cross(z, x), 0.0f), vec4(z, 0.0f), vec4(vec3(m[3]), 1.0f)};
}

}  // namespace quintet::scene
