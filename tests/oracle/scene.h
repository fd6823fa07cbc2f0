// SPDX-License-Identifier: Apache-2.0
// Geometry and instances of an oracle test. Primitives and instances keep their order on every device, so
// gl_PrimitiveID and gl_InstanceID are the indices in the scene.
#ifndef QUINTET_TESTS_ORACLE_SCENE_H
#define QUINTET_TESTS_ORACLE_SCENE_H

#include <cstddef>
#include <deque>
#include <memory>
#include <vector>

#include "rt/blas_builder.h"
#include "rt/tlas.h"

namespace quintet::oracle {

struct Triangles {
  std::vector<vec3> positions;
  std::vector<uvec3> indices;
  bool opaque = true;
  bool singleAnyHit = false;
};
struct Boxes {
  std::vector<Bounds3> boxes;
  bool opaque = true;
  bool singleAnyHit = false;
};

// Returns a triangle at (x, y) in the plane z with a distance of `size` from the center to the sides, counterclockwise
// as seen from +z.
Triangles triangleAt(float x, float y, float z, float size = 1.0f, bool opaque = true);
// Returns the cube around `center`.
Bounds3 boxAt(const vec3& center, float halfSize = 0.5f);

class Scene {
 public:
  // Both return the index of the BLAS, for add().
  std::size_t addBlas(const std::vector<Triangles>& geometries);
  std::size_t addBlas(const std::vector<Boxes>& geometries);
  // Sets `instance.blas`.
  void add(std::size_t blas, rt::InstanceInput instance = {});
  // Returns the TLAS. The first call builds it; nothing can be added afterwards.
  VkAccelerationStructureKHR handle() const;
  VkDeviceAddress address() const;

 private:
  std::size_t build(const rt::BlasInput& input);
  std::deque<rt::Blas> blas_;  // keeps addresses valid
  std::vector<rt::InstanceInput> instances_;
  mutable std::unique_ptr<rt::Tlas> tlas_;
};

}  // namespace quintet::oracle
#endif
