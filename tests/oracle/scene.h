// Geometry and instances of an oracle test. Primitives and instances keep their order on every device,
// so that gl_PrimitiveID and gl_InstanceID are the positions here.
#ifndef QUINTET_TESTS_ORACLE_SCENE_H
#define QUINTET_TESTS_ORACLE_SCENE_H

#include <deque>
#include <memory>
#include <vector>

#include "rt/acceleration_structure.h"

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

// One triangle around (x, y) in the plane z, `size` from the middle to the sides: from +z it is counterclockwise.
Triangles triangleAt(float x, float y, float z, float size = 1.0f, bool opaque = true);
// The cube around `center`.
Bounds3 boxAt(const vec3& center, float halfSize = 0.5f);

class Scene {
 public:
  // Each returns the number of the BLAS, for add().
  std::size_t addBlas(const std::vector<Triangles>& geometries);
  std::size_t addBlas(const std::vector<Boxes>& geometries);
  // With `instance.blas` left empty.
  void add(std::size_t blas, rt::InstanceInput instance = {});
  // The TLAS; built at the first call, nothing may be added after it.
  VkAccelerationStructureKHR handle() const;
  VkDeviceAddress address() const;

 private:
  std::size_t build(const rt::BlasInput& input);
  std::deque<rt::Blas> blas_;  // addresses stay
  std::vector<rt::InstanceInput> instances_;
  mutable std::unique_ptr<rt::Tlas> tlas_;
};

}  // namespace quintet::oracle
#endif
