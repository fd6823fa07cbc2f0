#include "scene/repair.h"

#include <algorithm>

namespace quintet::scene {
namespace {

// Normalises through a scale by the largest component, so that neither tiny nor huge vectors are lost.
bool normalize(vec3& v) {
  const float largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!isFinite(v) || !(largest > 0.0f)) return false;
  v /= largest;
  v /= glm::length(v);
  return true;
}

// Twice the area-weighted mean face normal per vertex, for the vertices in `wanted` only.
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

}  // namespace

std::size_t dropNonFiniteTriangles(Geometry& geometry) {
  auto& positions = geometry.positions;
  const auto good = std::ranges::find_if(positions, isFinite);
  if (std::ranges::all_of(good, positions.end(), isFinite) && good == positions.begin()) return 0;

  std::vector<uvec3> kept;
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < geometry.triangles.size(); ++i) {
    const uvec3& t = geometry.triangles[i];
    if (!isFinite(positions[t.x]) || !isFinite(positions[t.y]) || !isFinite(positions[t.z])) continue;
    kept.push_back(t);
    numbers.push_back(geometry.fileTriangles.empty() ? i : geometry.fileTriangles[i]);
  }
  const vec3 replacement = good == positions.end() ? vec3(0.0f) : *good;
  for (vec3& p : positions)
    if (!isFinite(p)) p = replacement;
  const std::size_t dropped = geometry.triangles.size() - kept.size();
  if (dropped > 0) geometry.fileTriangles = std::move(numbers);
  geometry.triangles = std::move(kept);
  return dropped;
}

void dropUnusedVertices(Geometry& geometry) {
  std::vector<std::uint32_t> newIndex(geometry.positions.size(), 0);
  for (const uvec3& t : geometry.triangles) newIndex[t.x] = newIndex[t.y] = newIndex[t.z] = 1;
  const auto used = static_cast<std::size_t>(std::ranges::count(newIndex, 1u));
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
  for (auto& set : geometry.uvs) compact(set);
  std::uint32_t next = 0;
  for (std::uint32_t& index : newIndex) index = index != 0 ? next++ : 0;
  for (uvec3& t : geometry.triangles) t = {newIndex[t.x], newIndex[t.y], newIndex[t.z]};
}

std::size_t repairNormals(Geometry& geometry) {
  std::vector<std::size_t> broken;
  for (std::size_t i = 0; i < geometry.normals.size(); ++i)
    if (!normalize(geometry.normals[i])) broken.push_back(i);
  if (broken.empty()) return 0;
  const std::vector<vec3> sums = faceNormalSums(geometry);
  for (const std::size_t i : broken) {
    geometry.normals[i] = sums[i];
    if (!normalize(geometry.normals[i])) geometry.normals[i] = vec3(0.0f, 1.0f, 0.0f);
  }
  return broken.size();
}

std::size_t repairTangents(Geometry& geometry) {
  std::size_t repaired = 0;
  for (std::size_t i = 0; i < geometry.tangents.size(); ++i) {
    vec3 t(geometry.tangents[i]);
    const float w = geometry.tangents[i].w < 0.0f ? -1.0f : 1.0f;
    if (!normalize(t)) {
      t = anyPerpendicular(geometry.normals[i]);
      ++repaired;
    }
    geometry.tangents[i] = vec4(t, w);
  }
  return repaired;
}

std::size_t repairUvsAndColors(Geometry& geometry) {
  std::size_t repaired = 0;
  for (auto& set : geometry.uvs) {
    for (vec2& uv : set) {
      if (std::isfinite(uv.x) && std::isfinite(uv.y)) continue;
      uv = vec2(0.0f);
      ++repaired;
    }
  }
  for (vec4& color : geometry.colors) {
    if (!isFinite(vec3(color)) || !std::isfinite(color.w)) {
      color = vec4(1.0f);
      ++repaired;
    }
    color = glm::max(color, vec4(0.0f));
  }
  return repaired;
}

vec3 anyPerpendicular(const vec3& n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  return {1.0f + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x};
}

}  // namespace quintet::scene
