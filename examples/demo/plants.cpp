// SPDX-License-Identifier: Apache-2.0
// Plant parts of mesh_builder.h: ropes along curves, and leaves.
#include <algorithm>

#include "demo/mesh_builder.h"

namespace quintet::demo {

TriangleMesh tube(std::span<const vec3> curve, float startRadius, float endRadius, int around) {
  // A frame along the curve without twist (parallel transport).
  std::vector<vec3> across;
  vec3 previous = curve[1] - curve[0];
  vec3 normal = glm::cross(previous, std::abs(previous.y) < std::abs(previous.x) ? vec3(0, 1, 0) : vec3(1, 0, 0));
  const auto tangentAt = [&](std::size_t i) {
    return glm::normalize(curve[std::min(i + 1, curve.size() - 1)] - curve[i > 0 ? i - 1 : 0]);
  };
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const vec3 tangent = tangentAt(i);
    normal = glm::normalize(normal - tangent * glm::dot(normal, tangent));
    across.push_back(normal);
  }

  // One row per point of the curve, and a row of radius 0 at each end.
  const int last = static_cast<int>(curve.size()) + 1;
  TriangleMesh mesh = parametric(around, last, true, false, [&](float u, float v) {
    const int row = static_cast<int>(std::lround(v * static_cast<float>(last)));
    const auto i = static_cast<std::size_t>(glm::clamp(row - 1, 0, last - 2));
    if (row == 0 || row == last) return curve[i];
    const float radius = glm::mix(startRadius, endRadius, static_cast<float>(i) / static_cast<float>(last - 2));
    const float angle = 2.0f * kPi * u;
    return curve[i] + radius * (std::cos(angle) * across[i] + std::sin(angle) * glm::cross(tangentAt(i), across[i]));
  });
  computeNormals(mesh, 60.0f);
  return mesh;
}

TriangleMesh leaf(vec3 base, vec3 direction, vec3 up, float length, float width, float bend) {
  const vec3 forward = glm::normalize(direction);
  const vec3 side = glm::normalize(glm::cross(forward, up));
  const vec3 normal = glm::cross(side, forward);
  TriangleMesh mesh = parametric(6, 14, false, false, [&](float u, float v) {
    const float across = 2.0f * u - 1.0f;
    const float half = 0.5f * width * std::pow(std::sin(kPi * std::pow(v, 0.85f)), 0.8f);
    const float rise = -bend * length * v * v + 0.35f * half * across * across;  // bent downwards and cupped
    const bool tip = v == 0.0f || v == 1.0f;
    return base + forward * (length * v * (1.0f - 0.25f * bend * v)) + side * (tip ? 0.0f : half * across) +
           normal * (tip ? -bend * length * v * v : rise);
  });
  computeNormals(mesh);
  return mesh;
}

}  // namespace quintet::demo
