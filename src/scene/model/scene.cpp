// SPDX-License-Identifier: Apache-2.0
#include "scene/model/scene.h"

#include <algorithm>

namespace quintet::scene {

bool isAnimated(const Scene& scene) {
  const auto hasKeyframes = [](const Instance& instance) { return !instance.keyframes.empty(); };
  return scene.nodeAnimation != nullptr || std::ranges::any_of(scene.instances, hasKeyframes);
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
