// The emissive geometries of a scene's meshes, in object space: what the tables of lights are made from, for any place
// of the instances.
#ifndef QUINTET_RENDER_LIGHT_EMITTERS_H
#define QUINTET_RENDER_LIGHT_EMITTERS_H

#include <algorithm>
#include <memory>
#include <vector>

#include "base/parallel.h"
#include "render/light_bounds.h"
#include "scene/scene.h"

namespace quintet::render {

// Mean luminance of each triangle or solid of a geometry, the same for all instances of its mesh.
struct Emitter {
  std::vector<float> luminance;
  bool black = true;
  // One of these: the scene's, or after keep() a copy of the members that matter here.
  const scene::Geometry* triangles = nullptr;
  const scene::PrimitiveSet* solids = nullptr;
  std::shared_ptr<const scene::Geometry> ownTriangles;
  std::shared_ptr<const scene::PrimitiveSet> ownSolids;

  void keep();
  std::size_t count() const { return luminance.size(); }
};

// By mesh and geometry; a mesh without emission has none. Unlit materials and trees of solids do not emit here.
std::vector<std::vector<Emitter>> makeEmitters(const scene::Scene& scene);

// Triangle or solid i of the emitter in an instance.
double emitterArea(const Emitter& emitter, std::size_t i, const mat4& worldFromObject);  // m²
// Their intensity is that of a luminance of 1.
LightBounds emitterBounds(const Emitter& emitter, std::size_t i, const mat4& worldFromObject, double area);

// Calls body(i) for each i below count, some thousand at a time on all cores.
template <class Body>
void forManyInParallel(std::size_t count, const Body& body) {
  constexpr std::size_t kPerTask = 4096;
  parallelFor((count + kPerTask - 1) / kPerTask, [&](std::size_t task) {
    const std::size_t end = std::min(count, (task + 1) * kPerTask);
    for (std::size_t i = task * kPerTask; i < end; ++i) body(i);
  });
}

}  // namespace quintet::render
#endif
