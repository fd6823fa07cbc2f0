// SPDX-License-Identifier: Apache-2.0
#include "scene/model/scene.h"

#include <algorithm>

#include "base/parallel.h"

namespace quintet::scene {
namespace {

// Up to this number of instanced vertices and primitives, worldBounds() is exact (a fraction of a second). Above it, it
// returns the bounds of the transformed object bounds.
constexpr std::uint64_t kExactVertexCount = 20'000'000;

// Bounds of all points after `transform`, on all cores.
template <class Transform>
Bounds3 boundsOfPoints(const std::vector<vec3>& points, const Transform& transform) {
  constexpr std::size_t kGrain = 65536;
  std::vector<Bounds3> parts((points.size() + kGrain - 1) / kGrain);
  parallelRanges(
      points.size(),
      [&](std::size_t first, std::size_t last) {
        Bounds3 part;
        for (std::size_t i = first; i < last; ++i) part.extend(transform(points[i]));
        parts[first / kGrain] = part;
      },
      kGrain);
  Bounds3 bounds;
  for (const Bounds3& part : parts) bounds.extend(part);
  return bounds;
}

Bounds3 objectBounds(const Mesh& mesh) {
  Bounds3 bounds;
  for (const Geometry& geometry : mesh.geometries)
    bounds.extend(boundsOfPoints(geometry.positions, [](const vec3& p) { return p; }));
  for (const PrimitiveSet& set : mesh.primitiveSets) bounds.extend(boundsOf(set));
  return bounds;
}

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
  Bounds3 bounds;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = meshOf(scene, instance);
    for (const Geometry& geometry : mesh.geometries)
      bounds.extend(boundsOfPoints(geometry.positions,
                                   [&](const vec3& p) { return vec3(instance.worldFromObject * vec4(p, 1.0f)); }));
    for (const PrimitiveSet& set : mesh.primitiveSets) bounds.extend(boundsOf(set, instance.worldFromObject));
  }
  return bounds;
}

Bounds3 boundsOfBoxes(const Scene& scene) {
  std::vector<Bounds3> boxes;
  for (const Mesh& mesh : scene.meshes) boxes.push_back(objectBounds(mesh));
  Bounds3 bounds;
  for (const Instance& instance : scene.instances)
    bounds.extend(boxes[static_cast<std::size_t>(instance.mesh)].transformed(instance.worldFromObject));
  return bounds;
}

}  // namespace

bool isAnimated(const Scene& scene) {
  const auto hasKeyframes = [](const Instance& instance) { return !instance.keyframes.empty(); };
  return scene.nodeAnimation != nullptr || std::ranges::any_of(scene.instances, hasKeyframes);
}

Bounds3 worldBounds(const Scene& scene) {
  std::uint64_t count = 0;
  for (const Instance& instance : scene.instances) count += countPoints(meshOf(scene, instance));
  return count <= kExactVertexCount ? exactBounds(scene) : boundsOfBoxes(scene);
}

TriangleCount countTriangles(const Scene& scene) {
  std::vector<std::uint64_t> counts;
  TriangleCount result;
  for (const Mesh& mesh : scene.meshes) {
    std::uint64_t count = 0;
    for (const Geometry& geometry : mesh.geometries) count += geometry.triangles.size();
    counts.push_back(count);
    result.stored += count;
  }
  for (const Instance& instance : scene.instances) result.instanced += counts[static_cast<std::size_t>(instance.mesh)];
  return result;
}

ProceduralCount countProcedural(const Scene& scene) {
  ProceduralCount count;
  for (const Mesh& mesh : scene.meshes) {
    for (const PrimitiveSet& set : mesh.primitiveSets) {
      ++count.sets;
      if (set.kind == PrimitiveSetKind::solids) count.solids += set.primitives.size();
      if (set.kind == PrimitiveSetKind::csg) count.csgLeaves += set.primitives.size();
      count.csgTrees += set.trees.size();
      count.customBoxes += set.boxes.size();
    }
  }
  return count;
}

}  // namespace quintet::scene
