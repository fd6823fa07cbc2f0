// The probabilities of quintet/lights/tree.glsl again, in double precision and by angles instead of cosines.
#ifndef QUINTET_TESTS_GPU_LIGHTS_TREE_ORACLE_H
#define QUINTET_TESTS_GPU_LIGHTS_TREE_ORACLE_H

#include <algorithm>
#include <cmath>
#include <glm/gtc/packing.hpp>
#include <vector>

#include "quintet/shared/frame.h"
#include "render/light_tree.h"

namespace quintet::test {

// LightReceiver of GLSL; the flag as a word.
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
  double facing = 1.0;
  if (receiver.normal != vec3(0.0f)) {
    const double cosine = glm::dot(dvec3(receiver.normal), wi);
    facing = std::cos(std::max(0.0, angle(receiver.opaque ? cosine : std::abs(cosine)) - within));
  }
  if (facing < -1e-3) return 0.0;
  const double strength = node.intensity * std::max(facing, 0.0625);
  if (infinite) return strength;
  const double leaving = -glm::dot(axis, wi);
  const double off = angle((node.link & shared::kLightNodeBothSides) != 0 ? std::abs(leaving) : leaving);
  const double emission = std::cos(std::max(0.0, std::max(0.0, off - angle(cone.x)) - within));
  if (emission < cone.y - 1e-3) return 0.0;
  return std::clamp(strength * std::max(emission, 0.01) / std::max(distance * distance, radius * radius), 1e-35, 1e30);
}

// Of each light; what is missing to 1 comes to lights that give nothing.
inline std::vector<double> oracleProbabilities(const std::vector<shared::LightNode>& nodes, std::size_t lightCount, const Receiver& receiver) {
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
    double chance = a / (a + b);
    if (a > 0.0 && b > 0.0 && (nodes[index].link & shared::kLightNodeShare) != 0) chance = 0.15 + 0.7 * chance;
    if (a > 0.0) open.push_back({index, visit.probability * chance});
    if (b > 0.0) open.push_back({index + 1, visit.probability * (1.0 - chance)});
  }
  return result;
}

}  // namespace quintet::test
#endif
