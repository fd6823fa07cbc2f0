// Surfaces that are not triangles: analytic solids, trees of them (constructive solid geometry), and boxes
// whose surface a user's intersection shader defines.
#ifndef QUINTET_SCENE_PROCEDURAL_H
#define QUINTET_SCENE_PROCEDURAL_H

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

// Solids that wait on the stack while a tree is evaluated in postfix order: what a shader may keep.
inline constexpr std::uint32_t kMaxCsgStack = 32;

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
  std::vector<Bounds3> boxes;  // custom
  int material = -1;           // custom: Scene::materials
};

// Boxes in the BLAS.
inline std::size_t boxCount(const PrimitiveSet& set) {
  return set.kind == PrimitiveSetKind::solids ? set.primitives.size()
         : set.kind == PrimitiveSetKind::csg  ? set.trees.size()
                                              : set.boxes.size();
}

// Tight boxes, rounded outwards, in the space that `m` takes the primitive's own object space to.
// A tree: the boxes of its operands united, intersected or, for a difference, the left one; empty if an
// intersection has nothing in common.
Bounds3 boundsOf(const Primitive&, const mat4& m = mat4(1.0f));
Bounds3 boundsOf(const PrimitiveSet&, const CsgTree&, const mat4& m = mat4(1.0f));
Bounds3 boundsOf(const PrimitiveSet&, const mat4& m = mat4(1.0f));
// What goes into the BLAS, in object space: boxCount() boxes. An empty tree becomes a point of its first leaf's
// box, so that numbers stay.
std::vector<Bounds3> boxesOf(const PrimitiveSet&);

// What is wrong with the nodes of one tree (a leaf beyond `primitiveCount`, an operation without two operands,
// more than one result, a stack beyond kMaxCsgStack), or nothing.
std::string csgProblem(std::span<const CsgNode> nodes, std::size_t primitiveCount);
// Largest number of solids on the stack while a well-formed tree is evaluated.
std::uint32_t csgStackSize(std::span<const CsgNode> nodes);
// The same solid with the smallest stack that swapping the operands of unite and intersect can give: the operand
// that needs more comes first (Sethi and Ullman 1970). Of a well-formed tree.
std::vector<CsgNode> orderForSmallStack(std::span<const CsgNode> nodes);

}  // namespace quintet::scene
#endif
