// SPDX-License-Identifier: Apache-2.0
#include "scene/animation/deform.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/parallel.h"

namespace quintet::scene {
namespace {

// Inverse transpose up to a positive factor: the signed cofactors, without a division.
mat3 normalMatrix(const mat3& m) {
  const mat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::dot(m[0], cofactors[0]) < 0.0f ? -1.0f * cofactors : cofactors;
}

void addScaled(std::vector<vec3>& values, const std::vector<vec3>& displacements, float weight) {
  if (values.empty() || displacements.empty()) return;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += weight * displacements[i];
}

void transformVertex(Geometry& geometry, std::size_t i, const mat4& matrix) {
  const mat3 linear(matrix);
  geometry.positions[i] = vec3(matrix * vec4(geometry.positions[i], 1.0f));
  if (!geometry.normals.empty()) geometry.normals[i] = normalMatrix(linear) * geometry.normals[i];
  if (!geometry.tangents.empty())
    geometry.tangents[i] = vec4(linear * vec3(geometry.tangents[i]), geometry.tangents[i].w);
}

// Whether the vertex has more than half of its weight from joints that mirror.
bool isMirrored(std::span<const SkinSet> sets, const std::vector<bool>& mirroring, std::size_t i) {
  float sum = 0.0f, mirrored = 0.0f;
  for (const SkinSet& set : sets)
    for (glm::length_t c = 0; c < 4; ++c) {
      sum += set.weights[i][c];
      if (mirroring[set.joints[i][c]]) mirrored += set.weights[i][c];
    }
  return std::isfinite(sum) && sum > 0.0f ? mirrored > 0.5f * sum : bool{mirroring[sets[0].joints[i].x]};
}

void swapWinding(uvec3& triangle) { std::swap(triangle.y, triangle.z); }

void turnMirroredParts(Geometry& geometry, std::span<const SkinSet> sets, std::span<const mat4> matrices) {
  std::vector<bool> mirroring;
  for (const mat4& matrix : matrices) mirroring.push_back(mirrors(matrix));
  if (std::ranges::find(mirroring, true) == mirroring.end()) return;
  std::vector<bool> mirrored(geometry.positions.size());
  for (std::size_t i = 0; i < mirrored.size(); ++i) mirrored[i] = isMirrored(sets, mirroring, i);
  for (uvec3& t : geometry.triangles)
    if (int{mirrored[t.x]} + int{mirrored[t.y]} + int{mirrored[t.z]} >= 2) swapWinding(t);
  for (std::size_t i = 0; i < geometry.tangents.size(); ++i)
    if (mirrored[i]) geometry.tangents[i].w *= -1.0f;
}

}  // namespace

bool mirrors(const mat4& matrix) { return glm::determinant(glm::dmat3(mat3(matrix))) < 0.0; }

void applyMorphTarget(Geometry& geometry, const MorphTarget& target, float weight) {
  addScaled(geometry.positions, target.positions, weight);
  addScaled(geometry.normals, target.normals, weight);
  if (geometry.tangents.empty() || target.tangents.empty()) return;
  for (std::size_t i = 0; i < geometry.tangents.size(); ++i)
    geometry.tangents[i] += vec4(weight * target.tangents[i], 0.0f);
}

void applySkin(Geometry& geometry, std::span<const SkinSet> sets, std::span<const mat4> matrices) {
  constexpr std::size_t kVerticesPerTask = 8192;
  const auto skin = [&](std::size_t i) {
    float sum = 0.0f;
    for (const SkinSet& set : sets) sum += set.weights[i].x + set.weights[i].y + set.weights[i].z + set.weights[i].w;
    mat4 blended(0.0f);
    if (std::isfinite(sum) && sum > 0.0f) {
      for (const SkinSet& set : sets)
        for (std::size_t c = 0; c < 4; ++c)
          if (set.weights[i][c] != 0.0f) blended += (set.weights[i][c] / sum) * matrices[set.joints[i][c]];
    } else {
      blended = matrices[sets[0].joints[i].x];  // without a weight, the first joint applies
    }
    transformVertex(geometry, i, blended);
  };
  parallelRanges(
      geometry.positions.size(),
      [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) skin(i);
      },
      kVerticesPerTask);
  turnMirroredParts(geometry, sets, matrices);
}

void transformVertices(Geometry& geometry, const mat4& matrix) {
  for (std::size_t i = 0; i < geometry.positions.size(); ++i) transformVertex(geometry, i, matrix);
  if (!mirrors(matrix)) return;
  std::ranges::for_each(geometry.triangles, swapWinding);
  for (vec4& tangent : geometry.tangents) tangent.w *= -1.0f;
}

void applyTransform(Geometry& geometry, const mat4& matrix) {
  if (glm::determinant(mat3(matrix)) == 0.0f) {
    geometry.normals.clear();
    geometry.tangents.clear();
  }
  transformVertices(geometry, matrix);
}

}  // namespace quintet::scene
