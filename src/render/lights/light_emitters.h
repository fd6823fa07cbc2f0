// SPDX-License-Identifier: Apache-2.0
// The emissive geometries of a scene's meshes in object space: mean luminance with textures, area, and bounds. The
// light tables are built from them for any transforms of the instances.
#ifndef QUINTET_RENDER_LIGHTS_LIGHT_EMITTERS_H
#define QUINTET_RENDER_LIGHTS_LIGHT_EMITTERS_H

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "render/lights/light_bounds.h"
#include "scene/model/scene.h"

namespace quintet::render {

// A geometry or primitive set of a mesh, shared by all instances of the mesh.
struct Emitter {
  std::vector<float> luminance;  // mean emitted luminance per triangle or solid
  bool black = true;             // every luminance is 0
  // One of these points to the scene, or to the emitter's copy after copyGeometry(). The other one is null.
  const scene::Geometry* triangles = nullptr;
  const scene::PrimitiveSet* solids = nullptr;
  std::shared_ptr<scene::Geometry> ownTriangles;
  std::shared_ptr<const scene::PrimitiveSet> ownSolids;

  std::size_t count() const { return luminance.size(); }
};

// The emitters of a scene. Unlit and invisible materials and CSG trees are not emitters.
class Emitters {
 public:
  explicit Emitters(const scene::Scene& scene) { update(scene); }
  // Computes the emitters of the materials whose emission differs from that of the last scene. The scene has the meshes
  // and the images of the last one. Returns false if no emission differs.
  bool update(const scene::Scene& scene);
  // Makes the emitters independent of the scene: copies the positions and triangles, or the primitive sets.
  void copyGeometry();
  // Whether the geometry consists of triangles that emit. After copyGeometry().
  bool hasPositions(std::size_t mesh, std::size_t geometry) const {
    return !emitters_[mesh][geometry].black && emitters_[mesh][geometry].ownTriangles;
  }
  // Moves the vertices of a geometry that emits; does nothing for others. After copyGeometry().
  void setPositions(std::size_t mesh, std::size_t geometry, std::span<const vec3> positions);
  // Returns the emitter of a geometry or primitive set of a mesh.
  const Emitter& of(std::size_t mesh, std::size_t geometry) const { return emitters_[mesh][geometry]; }

 private:
  // What the emission of a material depends on.
  struct Emission {
    vec3 factor{0.0f};  // 0 means that the material does not emit
    scene::TextureUse texture;
    bool operator==(const Emission&) const = default;
  };
  std::vector<std::vector<Emitter>> emitters_;  // by mesh and geometry
  std::vector<Emission> emissions_;             // by material
};

// Returns the area of triangle or solid i of the emitter in an instance, in square meters.
double emitterArea(const Emitter& emitter, std::size_t i, const mat4& worldFromObject);
// Returns bounds whose intensity is that of a luminance of 1 on this area.
LightBounds emitterBounds(const Emitter& emitter, std::size_t i, const mat4& worldFromObject, double area);

// Returns the surface area of a solid under an affine transform. It is exact for boxes and for similarity transforms;
// otherwise it is found by quadrature, with an error of about 1e-3 at moderate stretch.
double solidArea(const scene::Primitive& primitive, const glm::dmat3& worldFromObject);

// Calls body(i) for each i below count, in tasks of a few thousand on all cores.
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
