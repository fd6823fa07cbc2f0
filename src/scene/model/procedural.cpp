// SPDX-License-Identifier: Apache-2.0
#include "scene/model/procedural.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace quintet::scene {
namespace {

using glm::dmat4;
using glm::dvec3;

// Support function of a canonical solid: the maximum of a · p over its points p.
double support(const Primitive& primitive, const dvec3& a) {
  const double radial = std::sqrt(a.x * a.x + a.z * a.z);
  switch (primitive.type) {
    case PrimitiveType::sphere: return glm::length(a);
    case PrimitiveType::box: return std::abs(a.x) + std::abs(a.y) + std::abs(a.z);
    case PrimitiveType::cylinder: return radial + std::abs(a.y);
    case PrimitiveType::cone: return std::max(a.y, radial - a.y);  // the apex, or a point on the rim of the base
    case PrimitiveType::torus: return radial + static_cast<double>(primitive.parameter) * glm::length(a);
  }
  return 0.0;
}

float roundedDown(double x) {
  const auto f = static_cast<float>(x);
  return f > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float roundedUp(double x) { return -roundedDown(-x); }

Bounds3 intersection(const Bounds3& a, const Bounds3& b) {
  const Bounds3 both{glm::max(a.min, b.min), glm::min(a.max, b.max)};
  return both.empty() ? Bounds3{} : both;
}

std::span<const CsgNode> nodesOf(const PrimitiveSet& set, const CsgTree& tree) {
  return std::span(set.nodes).subspan(tree.firstNode, tree.nodeCount);
}

// The subtree of a node.
struct Subtree {
  std::size_t size = 1;     // number of nodes, with the root
  std::uint32_t stack = 1;  // smallest sufficient stack
};

// The right operand of node i ends at i - 1, the left one before that.
std::size_t rightOf(std::size_t i) { return i - 1; }
std::size_t leftOf(const std::vector<Subtree>& subtrees, std::size_t i) { return i - 1 - subtrees[i - 1].size; }

std::vector<Subtree> subtreesOf(std::span<const CsgNode> nodes) {
  std::vector<Subtree> result(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].operation == CsgOperation::leaf) continue;
    const Subtree& right = result[rightOf(i)];
    const Subtree& left = result[leftOf(result, i)];
    const bool swap = nodes[i].operation != CsgOperation::subtract && right.stack > left.stack;
    const Subtree& first = swap ? right : left;
    const Subtree& second = swap ? left : right;
    result[i] = {1 + left.size + right.size, std::max(first.stack, second.stack + 1)};
  }
  return result;
}

}  // namespace

Bounds3 boundsOf(const Primitive& primitive, const mat4& m) {
  const dmat4 transform = dmat4(m) * dmat4(primitive.objectFromPrimitive);
  Bounds3 bounds;
  for (int axis = 0; axis < 3; ++axis) {
    const dvec3 row(transform[0][axis], transform[1][axis], transform[2][axis]);
    const double center = transform[3][axis];
    bounds.min[axis] = roundedDown(center - support(primitive, -row));
    bounds.max[axis] = roundedUp(center + support(primitive, row));
  }
  return bounds;
}

Bounds3 boundsOf(const PrimitiveSet& set, const CsgTree& tree, const mat4& m) {
  std::vector<Bounds3> stack;
  for (const CsgNode& node : nodesOf(set, tree)) {
    if (node.operation == CsgOperation::leaf) {
      stack.push_back(boundsOf(set.primitives[node.primitive], m));
      continue;
    }
    const Bounds3 right = stack.back();
    stack.pop_back();
    if (node.operation == CsgOperation::unite) stack.back().extend(right);
    if (node.operation == CsgOperation::intersect) stack.back() = intersection(stack.back(), right);
  }
  return stack.empty() ? Bounds3{} : stack.back();
}

Bounds3 boundsOf(const PrimitiveSet& set, const mat4& m) {
  Bounds3 bounds;
  switch (set.kind) {
    case PrimitiveSetKind::solids:
      for (const Primitive& primitive : set.primitives) bounds.extend(boundsOf(primitive, m));
      break;
    case PrimitiveSetKind::csg:
      for (const CsgTree& tree : set.trees) bounds.extend(boundsOf(set, tree, m));
      break;
    case PrimitiveSetKind::custom:
      for (const Bounds3& box : set.boxes) bounds.extend(box.transformed(m));
      break;
  }
  return bounds;
}

std::vector<Bounds3> boxesOf(const PrimitiveSet& set) {
  if (set.kind == PrimitiveSetKind::custom) return set.boxes;
  std::vector<Bounds3> boxes;
  boxes.reserve(boxCount(set));
  if (set.kind == PrimitiveSetKind::solids) {
    for (const Primitive& primitive : set.primitives) boxes.push_back(boundsOf(primitive));
    return boxes;
  }
  for (const CsgTree& tree : set.trees) {
    Bounds3 box = boundsOf(set, tree);
    if (box.empty()) {
      const vec3 point = boundsOf(set.primitives[set.nodes[tree.firstNode].primitive]).min;
      box = {point, point};
    }
    boxes.push_back(box);
  }
  return boxes;
}

std::string csgProblem(std::span<const CsgNode> nodes, std::size_t primitiveCount) {
  std::size_t depth = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const CsgNode& node = nodes[i];
    if (node.operation == CsgOperation::leaf) {
      if (node.primitive >= primitiveCount)
        return fmt::format("node {}: primitive {} of {}", i, node.primitive, primitiveCount);
      ++depth;
    } else {
      if (node.operation > CsgOperation::subtract) return fmt::format("node {}: unknown operation", i);
      if (depth < 2) return fmt::format("node {}: an operation needs two operands", i);
      --depth;
    }
  }
  if (depth != 1) return fmt::format("{} results, expected one", depth);
  const std::uint32_t stack = csgStackSize(nodes);
  if (stack > kMaxCsgStack) return fmt::format("needs a stack of {}; the maximum is {}", stack, kMaxCsgStack);
  return {};
}

std::uint32_t csgStackSize(std::span<const CsgNode> nodes) {
  std::uint32_t depth = 0, largest = 0;
  for (const CsgNode& node : nodes) {
    depth = node.operation == CsgOperation::leaf ? depth + 1 : depth - 1;
    largest = std::max(largest, depth);
  }
  return largest;
}

std::vector<CsgNode> orderForSmallStack(std::span<const CsgNode> nodes) {
  const std::vector<Subtree> subtrees = subtreesOf(nodes);
  // From the root, with the second operand before the first, which is the reverse of postfix order.
  std::vector<CsgNode> reversed;
  reversed.reserve(nodes.size());
  std::vector<std::size_t> waiting{nodes.size() - 1};
  while (!waiting.empty()) {
    const std::size_t i = waiting.back();
    waiting.pop_back();
    reversed.push_back(nodes[i]);
    if (nodes[i].operation == CsgOperation::leaf) continue;
    std::size_t first = leftOf(subtrees, i), second = rightOf(i);
    if (nodes[i].operation != CsgOperation::subtract && subtrees[second].stack > subtrees[first].stack)
      std::swap(first, second);
    waiting.push_back(first);
    waiting.push_back(second);
  }
  std::ranges::reverse(reversed);
  return reversed;
}

}  // namespace quintet::scene
