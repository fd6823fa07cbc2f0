#include "scene/scene.h"

namespace quintet::scene {
namespace {

Bounds3 objectBounds(const Mesh& mesh) {
  Bounds3 bounds;
  for (const Geometry& geometry : mesh.geometries)
    for (const vec3& p : geometry.positions) bounds.extend(p);
  return bounds;
}

}  // namespace

Bounds3 worldBounds(const Scene& scene) {
  std::vector<Bounds3> meshBounds;
  for (const Mesh& mesh : scene.meshes) meshBounds.push_back(objectBounds(mesh));
  Bounds3 bounds;
  for (const Instance& instance : scene.instances)
    bounds.extend(meshBounds[static_cast<std::size_t>(instance.mesh)].transformed(instance.worldFromObject));
  return bounds;
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

}  // namespace quintet::scene
