// Surfaces that are not triangles: analytic solids, trees of them (constructive solid geometry), and boxes
// whose surface a user's intersection shader defines.
#ifndef QUINTET_SCENE_PROCEDURAL_H
#define QUINTET_SCENE_PROCEDURAL_H

#include <cstdint>
#include <string>
#include <vector>

#include "base/math.h"

namespace quintet::scene {

// Canonical solids, closed, in their own space (y up):
//   sphere    radius 1 about the origin
//   box       [-1,1]³
//   cylinder  radius 1 about the y axis, -1 ≤ y ≤ 1, with both caps
//   cone      apex (0,1,0), base of radius 1 at y = -1, with its cap
//   torus     about the y axis, major radius 1, minor radius `parameter`
enum class PrimitiveType : std::uint32_t { sphere, box, cylinder, cone, torus };

struct Primitive {
  PrimitiveType type = PrimitiveType::sphere;
  mat4 objectFromPrimitive{1.0f};  // affine, invertible: places, scales and turns the canonical solid
  float parameter = 0.25f;         // torus: minor radius, (0,1)
  int material = -1;               // Scene::materials; -1: the default material
};

// A node of a tree in postfix order: a leaf pushes its solid, an operation takes the two on top.
// difference: the lower one minus the upper one.
enum class CsgOperation : std::uint32_t { leaf, unite, intersect, subtract };
struct CsgNode {
  CsgOperation operation = CsgOperation::leaf;
  std::uint32_t primitive = 0;  // leaf: index in PrimitiveSet::primitives
};
struct CsgTree {
  std::uint32_t firstNode = 0;  // in PrimitiveSet::nodes
  std::uint32_t nodeCount = 0;  // leaves k, operations k - 1
};

// One geometry of boxes in a BLAS. What a box holds depends on the kind:
//   solids   box i holds primitives[i]
//   csg      box i holds trees[i]
//   custom   box i is boxes[i]; its surface is the program's business
enum class PrimitiveSetKind : std::uint32_t { solids, csg, custom };
struct PrimitiveSet {
  std::string name;  // hit groups are bound to it by this name
  PrimitiveSetKind kind = PrimitiveSetKind::solids;
  std::vector<Primitive> primitives;
  std::vector<CsgNode> nodes;
  std::vector<CsgTree> trees;
  std::vector<Bounds3> boxes;   // custom
  int material = -1;            // custom: Scene::materials
};

// Boxes in the BLAS.
inline std::size_t boxCount(const PrimitiveSet& set) {
  return set.kind == PrimitiveSetKind::solids ? set.primitives.size()
         : set.kind == PrimitiveSetKind::csg  ? set.trees.size()
                                              : set.boxes.size();
}

}  // namespace quintet::scene
#endif
