// SPDX-License-Identifier: Apache-2.0
// The probabilities of quintet/lights/tree.glsl, computed in double precision and with angles instead of cosines.
#ifndef QUINTET_TESTS_GPU_LIGHTS_TREE_ORACLE_H
#define QUINTET_TESTS_GPU_LIGHTS_TREE_ORACLE_H

#include <algorithm>
#include <cmath>
#include <vector>

#include "quintet/shared/frame.h"
#include "render/lights/light_tree.h"

namespace quintet::test {

// LightSampleContext of GLSL. The flag is a 32-bit word.
struct Receiver {
  vec3 position;
  vec3 normal{0.0f};  // 0: no surface
  std::uint32_t opaque = 0;
};

inline double oracleImportance(const shared::LightNode& node, const Receiver& receiver) {
  using glm::dvec3;
  const auto angle = [](double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)); };
  const bool infinite = (node.link & shared::kLightNodeInfinite) != 0;
  const dvec3 axis = render::unpackLightAxis(node.axis);
  const vec2 cone = glm::unpackSnorm2x16(node.cone);
  const dvec3 p(receiver.position), d = infinite ? axis : dvec3(node.center) - p;
  const double distance = glm::length(d);
  const double radius = node.radius + 5e-7 * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
  const dvec3 wi = distance > 0.0 ? d / distance : dvec3(0.0);
  const double within = infinite ? angle(cone.x) : distance > radius ? std::asin(radius / distance) : glm::pi<double>();
  // Angles between the direction to the center and the normals, and their minimum over the ball.
  double tilt = receiver.normal == vec3(0.0f) ? 0.0 : angle(glm::dot(dvec3(receiver.normal), wi));
  if (!receiver.opaque) tilt = std::min(tilt, glm::pi<double>() - tilt);
  const double leastTilt = std::max(0.0, tilt - within);
  if (std::cos(leastTilt) < -1e-3) return 0.0;
  if (infinite) return node.intensity * std::max(std::cos(leastTilt), 0.0625);
  double turn = angle(-glm::dot(axis, wi));
  if ((node.link & shared::kLightNodeBothSides) != 0) turn = std::min(turn, glm::pi<double>() - turn);
  turn = std::max(0.0, turn - angle(cone.x));
  const double leastTurn = std::max(0.0, turn - within);
  if (std::cos(leastTurn) < cone.y - 1e-3) return 0.0;
  const auto likely = [](double a, double least) { return 0.25 * std::cos(least) + 0.75 * std::max(0.0, std::cos(a)); };
  const double strength =
      node.intensity * std::max(likely(tilt, leastTilt), 0.0625) * std::max(likely(turn, leastTurn), 0.01);
  return std::clamp(strength / std::max(distance * distance, 0.125 * radius * radius), 1e-35, 1e30);
}

// Returns the probability of each light. The rest up to 1 is that of nodes whose lights cannot contribute.
inline std::vector<double> oracleProbabilities(const std::vector<shared::LightNode>& nodes, std::size_t lightCount,
                                               const Receiver& receiver) {
  std::vector<double> result(lightCount, 0.0);
  struct Visit {
    std::size_t node;
    double probability;
  };
  std::vector<Visit> open{{0, 1.0}};
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    const std::uint32_t link = nodes[visit.node].link, index = link & shared::kLightNodeIndex;
    if (visit.node == 0 && !(nodes[0].intensity > 0.0f)) break;
    if ((link & shared::kLightNodeLeaf) != 0) {
      result[index] = visit.probability;
      continue;
    }
    const double a = oracleImportance(nodes[index], receiver), b = oracleImportance(nodes[index + 1], receiver);
    if (a == 0.0 && b == 0.0) continue;
    double probability = a / (a + b);
    if (a > 0.0 && b > 0.0 && (nodes[index].link & shared::kLightNodeShare) != 0)
      probability = receiver.opaque ? 0.15 + 0.7 * probability : 0.5;
    if (a > 0.0) open.push_back({index, visit.probability * probability});
    if (b > 0.0) open.push_back({index + 1, visit.probability * (1.0 - probability)});
  }
  return result;
}

}  // namespace quintet::test
#endif
