// SPDX-License-Identifier: Apache-2.0
// Computes boxes and summed surface areas of the tree that halves a list of triangles (rt::halvingTreeCost), a level of
// subtrees with kTreeCostLeaves leaves per dispatch. A compute shader with one invocation per
// 2^kTreeCostSerialDepth leaves.
#extension GL_EXT_scalar_block_layout : require
#include <quintet/passes/pass_index.glsl>
#include <quintet/shared/deform.h>

layout(local_size_x = kPassGroupSize) in;
layout(push_constant, scalar) uniform TreeCostBlock { TreeCostPass pass; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TreeCostNodeArray { TreeCostNode at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer TreeCostOrder { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer TreeCostGeometryArray {
  TreeCostGeometry at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer TreeCostPositions { vec3 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer TreeCostTriangles { uvec3 at[]; };

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer TreeCostLists { TreeCostList at[]; };

shared TreeCostNode nodes[kPassGroupSize];

TreeCostNode emptyNode() { return TreeCostNode(vec3(1.0), vec3(-1.0), 0.0); }

bool isEmpty(TreeCostNode node) { return node.low.x > node.high.x; }

float areaOf(vec3 low, vec3 high) {
  const vec3 e = high - low;
  return 2.0 * (e.x * e.y + e.y * e.z + e.z * e.x);
}

// The parent of two nodes. A node without a right child stands for its left child.
TreeCostNode parentOf(TreeCostNode left, TreeCostNode right) {
  if (isEmpty(right)) return left;
  const vec3 low = min(left.low, right.low), high = max(left.high, right.high);
  return TreeCostNode(low, high, left.cost + right.cost + areaOf(low, high));
}

// The geometry of a triangle of the list.
TreeCostGeometry geometryOf(TreeCostList list, uint triangle) {
  uint first = 0u, last = list.geometryCount - 1u;
  while (first < last) {
    const uint middle = (first + last + 1u) / 2u;
    if (TreeCostGeometryArray(list.geometries).at[middle].first <= triangle)
      first = middle;
    else
      last = middle - 1u;
  }
  return TreeCostGeometryArray(list.geometries).at[first];
}

TreeCostNode triangleNode(TreeCostList list, uint triangle) {
  const TreeCostGeometry geometry = geometryOf(list, triangle);
  const uvec3 corners = TreeCostTriangles(geometry.triangles).at[triangle - geometry.first];
  const vec3 a = TreeCostPositions(geometry.positions).at[corners.x];
  const vec3 b = TreeCostPositions(geometry.positions).at[corners.y];
  const vec3 c = TreeCostPositions(geometry.positions).at[corners.z];
  const vec3 low = min(min(a, b), c), high = max(max(a, b), c);
  return TreeCostNode(low, high, areaOf(low, high));
}

// Leaf k of the level on which no node has more than one triangle. The left half of an odd count has one more.
TreeCostNode leafOf(uint k) {
  const TreeCostList list = TreeCostLists(pass.list).at[0];
  uint first = 0u, count = list.triangleCount;
  for (uint level = list.depth; level-- > 0u;) {
    const uint left = (count + 1u) / 2u;
    if ((k >> level & 1u) == 0u) {
      count = left;
    } else {
      first += left;
      count -= left;
    }
  }
  return count == 0u ? emptyNode() : triangleNode(list, TreeCostOrder(list.order).at[first]);
}

TreeCostNode inputOf(uint leaf) {
  if (leaf >= pass.leafCount) return emptyNode();
  if (pass.leaves == 0ul) return leafOf(leaf);
  return TreeCostNodeArray(pass.leaves).at[leaf];
}

TreeCostNode pairAt(uint leaf) { return parentOf(inputOf(leaf), inputOf(leaf + 1u)); }

void main() {
  const uint own = gl_LocalInvocationIndex, first = passIndex() << kTreeCostSerialDepth;
  nodes[own] = parentOf(parentOf(pairAt(first), pairAt(first + 2u)), parentOf(pairAt(first + 4u), pairAt(first + 6u)));
  for (uint stride = 1u; stride < kPassGroupSize; stride *= 2u) {
    barrier();
    if (own % (2u * stride) == 0u) nodes[own] = parentOf(nodes[own], nodes[own + stride]);
  }
  if (own == 0u && first < pass.leafCount) TreeCostNodeArray(pass.roots).at[first / kTreeCostLeaves] = nodes[0];
}
