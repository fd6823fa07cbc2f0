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

// Up to this number of instanced vertices and primitives, worldBounds() is exact (a fraction of a second). Above it, it
// returns the bounds of the transformed object bounds.
constexpr std::uint64_t kExactVertexCount = 20'000'000;

std::uint64_t countPoints(const Mesh& mesh) {
  std::uint64_t count = 0;
  for (const Geometry& geometry : mesh.geometries) count += geometry.positions.size();
  for (const PrimitiveSet& set : mesh.primitiveSets)
    count += set.primitives.size() + set.nodes.size() + set.boxes.size();
  return count;
}

const Mesh& meshOf(const Scene& scene, const Instance& instance) {
  return scene.meshes[static_cast<std::size_t>(instance.mesh)];
}

Bounds3 exactBounds(const Scene& scene) {
  // The visible vertices of each geometry of a mesh that has an instance.
  std::vector<std::vector<std::vector<std::uint8_t>>> visible(scene.meshes.size());
  Bounds3 bounds;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = meshOf(scene, instance);
    auto& known = visible[static_cast<std::size_t>(instance.mesh)];
    for (std::size_t g = known.size(); g < mesh.geometries.size(); ++g)
      known.push_back(visibleVertices(mesh.geometries[g]));
    for (std::size_t g = 0; g < mesh.geometries.size(); ++g)
      bounds.extend(geometryBounds(mesh.geometries[g], known[g], instance.worldFromObject));
    for (const PrimitiveSet& set : mesh.primitiveSets) bounds.extend(boundsOf(set, instance.worldFromObject));
  }
  return bounds;
}

Bounds3 boundsOfBoxes(const Scene& scene) {
  std::vector<Bounds3> boxes;
  for (const Mesh& mesh : scene.meshes) boxes.push_back(meshBounds(mesh, mat4(1.0f)));
  Bounds3 bounds;
  for (const Instance& instance : scene.instances)
    bounds.extend(boxes[static_cast<std::size_t>(instance.mesh)].transformed(instance.worldFromObject));
  return bounds;
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

// Declared in scene.h.
Bounds3 worldBounds(const Scene& scene) {
  std::uint64_t count = 0;
  for (const Instance& instance : scene.instances) count += countPoints(meshOf(scene, instance));
  return count <= kExactVertexCount ? exactBounds(scene) : boundsOfBoxes(scene);
}

}  // namespace quintet::scene
