// SPDX-License-Identifier: Apache-2.0
#include "scene/geometry/containment.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "base/parallel.h"

namespace quintet::scene {

using glm::dvec3;

double windingNumber(std::span<const vec3> positions, std::span<const uvec3> triangles, const dvec3& point) {
  // One sum per range, added in their order: the result does not depend on the number of cores.
  constexpr std::size_t kGrain = 16384;
  std::vector<double> sums((triangles.size() + kGrain - 1) / kGrain, 0.0);
  const auto addRange = [&](std::size_t first, std::size_t last) {
    double sum = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      const dvec3 a = dvec3(positions[triangles[i].x]) - point;
      const dvec3 b = dvec3(positions[triangles[i].y]) - point;
      const dvec3 c = dvec3(positions[triangles[i].z]) - point;
      const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
      const double denominator = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
      sum += std::atan2(glm::dot(a, glm::cross(b, c)), denominator);
    }
    sums[first / kGrain] = sum;
  };
  parallelRanges(triangles.size(), addRange, kGrain);
  double total = 0.0;
  for (const double sum : sums) total += sum;
  return total / (2.0 * std::numbers::pi);
}

bool contains(const Primitive& primitive, const dvec3& point) {
  const dvec3 p(glm::inverse(glm::dmat4(primitive.objectFromPrimitive)) * glm::dvec4(point, 1.0));
  const double radius = std::sqrt(p.x * p.x + p.z * p.z);
  switch (primitive.type) {
    case PrimitiveType::sphere: return glm::dot(p, p) < 1.0;
    case PrimitiveType::box: return std::abs(p.x) < 1.0 && std::abs(p.y) < 1.0 && std::abs(p.z) < 1.0;
    case PrimitiveType::cylinder: return radius < 1.0 && std::abs(p.y) < 1.0;
    case PrimitiveType::cone: return p.y > -1.0 && radius < 0.5 * (1.0 - p.y);
    case PrimitiveType::torus: return std::hypot(radius - 1.0, p.y) < static_cast<double>(primitive.parameter);
  }
  return false;
}

bool contains(const PrimitiveSet& set, const CsgTree& tree, const dvec3& point) {
  std::vector<bool> stack;
  for (std::uint32_t i = 0; i < tree.nodeCount; ++i) {
    const CsgNode& node = set.nodes[tree.firstNode + i];
    if (node.operation == CsgOperation::leaf) {
      stack.push_back(contains(set.primitives[node.primitive], point));
      continue;
    }
    const bool right = stack.back();
    stack.pop_back();
    const bool left = stack.back();
    switch (node.operation) {
      case CsgOperation::unite: stack.back() = left || right; break;
      case CsgOperation::intersect: stack.back() = left && right; break;
      case CsgOperation::subtract: stack.back() = left && !right; break;
      case CsgOperation::leaf: break;
    }
  }
  return !stack.empty() && stack.back();
}

}  // namespace quintet::scene
