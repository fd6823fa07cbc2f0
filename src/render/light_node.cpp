#include "render/light_node.h"

#include <algorithm>
#include <cmath>

namespace quintet::render {
namespace {

std::uint32_t packAxis(const vec3& n) {
  vec2 v = vec2(n) / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  if (n.z < 0.0f)
    v = vec2((1.0f - std::abs(v.y)) * (v.x >= 0.0f ? 1.0f : -1.0f),
             (1.0f - std::abs(v.x)) * (v.y >= 0.0f ? 1.0f : -1.0f));
  return glm::packSnorm2x16(v);
}

// Snorm of 16 bits that is not above the cosine.
std::uint32_t packCosine(double cosine) {
  const auto steps = static_cast<int>(std::floor(std::clamp(cosine, -1.0, 1.0) * 32767.0));
  return static_cast<std::uint16_t>(static_cast<std::int16_t>(steps));
}

}  // namespace

vec3 unpackLightAxis(std::uint32_t axis) {
  const vec2 v = glm::unpackSnorm2x16(axis);
  const float z = 1.0f - std::abs(v.x) - std::abs(v.y), fold = std::max(-z, 0.0f);
  return glm::normalize(vec3(v.x + (v.x >= 0.0f ? -fold : fold), v.y + (v.y >= 0.0f ? -fold : fold), z));
}

shared::LightNode packLightNode(const LightBounds& bounds) {
  shared::LightNode node{};
  node.center = bounds.center;
  node.radius = bounds.radius * (1.0f + 1e-5f) +
                4e-7f * (std::abs(node.center.x) + std::abs(node.center.y) + std::abs(node.center.z));
  node.intensity = bounds.intensity;
  node.axis = packAxis(bounds.axis);
  // Wider by the coding of the axis and what the unions have rounded.
  const vec3 coded = unpackLightAxis(node.axis);
  const double spread = bounds.spread + 2e-4 + std::asin(std::min(1.0f, glm::length(glm::cross(coded, bounds.axis))));
  const double full = bounds.bothSides ? 0.5 * glm::pi<double>() : glm::pi<double>();
  node.cone = packCosine(spread >= full ? -1.0 : std::cos(spread)) | packCosine(std::cos(bounds.beyond)) << 16;
  if (bounds.bothSides) node.link |= shared::kLightNodeBothSides;
  return node;
}

}  // namespace quintet::render
