// SPDX-License-Identifier: Apache-2.0
// CSG trees: which crossings of the solids are crossings of the tree, and which solid's surface is at a crossing. The
// algorithm stores no lists of crossings. It steps from crossing to crossing, and evaluates the whole tree for one t in
// one pass over its postfix nodes with a stack of bits. (Arrays with computed indices are slow, and lavapipe shares
// them between intersection and any-hit shaders.)
#ifndef QUINTET_PROCEDURAL_CSG_GLSL
#define QUINTET_PROCEDURAL_CSG_GLSL

#include "crossings.glsl"

// Crossings closer to each other than this, in units of the direction, count as one. Without it, rounding would leave
// thin layers between coincident surfaces. The value is 8 rounding errors of the point's coordinates.
float csgTolerance(vec3 origin, vec3 direction, float t) {
  const vec3 size = abs(origin) + abs(t * direction);
  return 4.8e-7 * maxComponent(size) * inversesqrt(dot(direction, direction));
}

// Replaces the top two bits of `stack` by the result of the operation; bit 0 is the top.
uint csgCombine(uint operation, uint stack) {
  const uint b = stack & 1u;
  const uint a = (stack >> 1) & 1u;
  const uint value = operation == kCsgUnite ? a | b : operation == kCsgIntersect ? a & b : a & (b ^ 1u);
  return ((stack >> 1) & ~1u) | value;
}

// True if the point just after t is inside the tree; `next`: the first crossing of any of its solids beyond t.
bool csgInsideAfter(GeometryData geometry, CsgTreeData tree, vec3 origin, vec3 direction, float t, out float next) {
  uint stack = 0u;
  next = kInfinity;
  for (uint i = 0u; i < tree.nodeCount; ++i) {
    const CsgNodeData node = CsgNodeArray(geometry.nodes).at[tree.firstNode + i];
    if (node.operation != kCsgLeaf) {
      stack = csgCombine(node.operation, stack);
      continue;
    }
    const vec4 crossings = primitiveCrossings(PrimitiveArray(geometry.primitives).at[node.operand], origin, direction);
    next = min(next, nextCrossing(crossings, t));
    stack = (stack << 1) | (insideAfter(crossings, t) ? 1u : 0u);
  }
  return (stack & 1u) != 0u;
}

// The solid whose surface is the tree's surface at its crossing t: an index in GeometryData::primitives. `entering`:
// the ray enters that solid there. If surfaces coincide, it is the operand that determines the result, or the first of
// two.
uint csgLeaf(GeometryData geometry, CsgTreeData tree, vec3 origin, vec3 direction, float t, out bool entering) {
  // All crossings that count as one with t lie in between. The interval also covers rounding differences between the
  // two compilations of this code.
  const float tolerance = csgTolerance(origin, direction, t);
  const float before = t - 0.5 * tolerance;
  const float after = t + 1.5 * tolerance;
  uint first = tree.firstNode;
  uint last = tree.firstNode + tree.nodeCount - 1u;
  uint nearest = 0u;
  uint crossingCount = 0u;
  float distance = kInfinity;
  for (bool whole = true;; whole = false) {
    // Stacks before and after the crossing, for the nodes before `last`. Its operands are the top two bits, unless it
    // is a leaf.
    uint stackBefore = 0u;
    uint stackAfter = 0u;
    const CsgNodeData top = CsgNodeArray(geometry.nodes).at[last];
    for (uint i = first; i <= last; ++i) {
      const CsgNodeData node = CsgNodeArray(geometry.nodes).at[i];
      if (node.operation != kCsgLeaf) {
        if (i == last) break;
        stackBefore = csgCombine(node.operation, stackBefore);
        stackAfter = csgCombine(node.operation, stackAfter);
        continue;
      }
      const vec4 crossings = primitiveCrossings(PrimitiveArray(geometry.primitives).at[node.operand], origin, direction);
      const bool insideThen = insideAfter(crossings, after);
      const bool insideNow = insideAfter(crossings, before);
      stackBefore = (stackBefore << 1) | (insideNow ? 1u : 0u);
      stackAfter = (stackAfter << 1) | (insideThen ? 1u : 0u);
      if (!whole) continue;
      if (insideThen != insideNow) crossingCount++;
      const vec4 gaps = abs(crossings - t);
      const float gap = min(min(gaps.x, gaps.y), min(gaps.z, gaps.w));
      if (gap < distance) {
        distance = gap;
        nearest = node.operand;
        entering = gap == gaps.x || gap == gaps.z;
      }
    }
    if (whole && crossingCount <= 1u) return nearest;
    if (top.operation == kCsgLeaf) {
      entering = (stackAfter & 1u) != 0u;
      return top.operand;
    }
    const bool invert = top.operation == kCsgSubtract;  // a and not b
    const bool a0 = (stackBefore & 2u) != 0u;
    const bool a1 = (stackAfter & 2u) != 0u;
    const bool b0 = ((stackBefore & 1u) != 0u) != invert;
    const bool b1 = ((stackAfter & 1u) != 0u) != invert;
    const bool unite = top.operation == kCsgUnite;
    const bool inside = unite ? a1 || b1 : a1 && b1;
    if (inside == (unite ? a0 || b0 : a0 && b0)) return nearest;  // thinner than the tolerance
    const bool firstDecides = unite ? (inside ? a1 : a0) : (inside ? !a0 : !a1);
    if (firstDecides) {
      last = last - 1u - top.operand;
    } else {
      first = last - top.operand;
      last = last - 1u;
    }
  }
}

#endif
