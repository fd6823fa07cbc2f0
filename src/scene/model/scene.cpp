// SPDX-License-Identifier: Apache-2.0
#include "scene/model/scene.h"

#include <algorithm>

#include "scene/model/mesh_bounds.h"

namespace quintet::scene {
namespace {

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
