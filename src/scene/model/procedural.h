// SPDX-License-Identifier: Apache-2.0
// Surfaces other than triangles: analytic solids, trees of them (constructive solid geometry, CSG), and boxes for the
// intersection shader of a program.
#ifndef QUINTET_SCENE_MODEL_PROCEDURAL_H
#define QUINTET_SCENE_MODEL_PROCEDURAL_H

#include <cstdint>
#include <span>
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
  mat4 objectFromPrimitive{1.0f};  // affine, invertible
  float parameter = 0.25f;         // torus: minor radius, (0,1)
  int material = -1;               // index in Scene::materials; -1 means the default material
};

// A node of a tree in postfix order: a leaf pushes its solid, an operation replaces the two solids on top of the stack.
// subtract: the lower solid minus the upper one.
enum class CsgOperation : std::uint32_t { leaf, unite, intersect, subtract };
struct CsgNode {
  CsgOperation operation = CsgOperation::leaf;
  std::uint32_t primitive = 0;  // of a leaf: index in PrimitiveSet::primitives
};
struct CsgTree {
  std::uint32_t firstNode = 0;  // index in PrimitiveSet::nodes
  std::uint32_t nodeCount = 0;  // k leaves and k - 1 operations
};

// Maximum number of solids on the stack while a shader evaluates a tree.
inline constexpr std::uint32_t kMaxCsgStack = 32;

// One geometry of boxes in a BLAS. The contents of box i depend on the kind:
//   solids   primitives[i]
//   csg      trees[i]
//   custom   boxes[i]; the program's intersection shader defines the surface
enum class PrimitiveSetKind : std::uint32_t { solids, csg, custom };
struct PrimitiveSet {
  std::string name;  // hit groups are bound to the set by this name
  PrimitiveSetKind kind = PrimitiveSetKind::solids;
  std::vector<Primitive> primitives;
  std::vector<CsgNode> nodes;
  std::vector<CsgTree> trees;
  std::vector<Bounds3> boxes;  // of a custom set
  int material = -1;           // of a custom set: index in Scene::materials
};

// Number of boxes in the BLAS.
inline std::size_t boxCount(const PrimitiveSet& set) {
  return set.kind == PrimitiveSetKind::solids ? set.primitives.size()
         : set.kind == PrimitiveSetKind::csg  ? set.trees.size()
                                              : set.boxes.size();
}

// Bounds after the transform `m` from object space, rounded outwards. Tight for a primitive. Those of a tree are the
// union or the intersection of the bounds of its operands, or the bounds of the left operand of a difference. They are
// empty if the bounds of an intersection are disjoint.
Bounds3 boundsOf(const Primitive&, const mat4& m = mat4(1.0f));
Bounds3 boundsOf(const PrimitiveSet&, const CsgTree&, const mat4& m = mat4(1.0f));
Bounds3 boundsOf(const PrimitiveSet&, const mat4& m = mat4(1.0f));
// The boxCount() boxes of the BLAS, in object space. An empty tree gets a point of the box of its first leaf, so that
// the numbering of the boxes is kept.
std::vector<Bounds3> boxesOf(const PrimitiveSet&);

// Describes the first error in the nodes of one tree: a leaf beyond `primitiveCount`, an operation without two
// operands, more than one result, a stack above kMaxCsgStack. Empty if the tree is valid.
std::string csgProblem(std::span<const CsgNode> nodes, std::size_t primitiveCount);
// Maximum number of solids on the stack while a valid tree is evaluated.
std::uint32_t csgStackSize(std::span<const CsgNode> nodes);
// Reorders a valid tree for the smallest stack that swapping the operands of unite and intersect can give: the operand
// that needs the larger stack comes first (Sethi and Ullman 1970).
std::vector<CsgNode> orderForSmallStack(std::span<const CsgNode> nodes);

}  // namespace quintet::scene
#endif
