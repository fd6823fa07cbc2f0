// SPDX-License-Identifier: Apache-2.0
#include "overlay/box_outline.h"

#include <array>
#include <cstddef>

#include "overlay/camera_projection.h"

namespace quintet::overlay {
namespace {

constexpr float kNearest = 1e-3f;  // of the distance to the center of the box: nearer points are not projected

vec3 cornerOf(const Bounds3& bounds, std::size_t index) {
  return {index & 1 ? bounds.max.x : bounds.min.x, index & 2 ? bounds.max.y : bounds.min.y,
          index & 4 ? bounds.max.z : bounds.min.z};
}

}  // namespace

std::vector<ImageLine> boxOutline(const scene::Camera& camera, uvec2 size, const Bounds3& bounds,
                                  const mat4& worldFromObject) {
  std::vector<ImageLine> lines;
  if (bounds.empty() || size.x == 0 || size.y == 0) return lines;
  const CameraProjection projection(camera, size);
  const mat4 cameraFromObject = projection.cameraFromWorld() * worldFromObject;
  std::array<vec3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = vec3(cameraFromObject * vec4(cornerOf(bounds, i), 1.0f));
  const float nearest = -kNearest * glm::length(vec3(cameraFromObject * vec4(bounds.center(), 1.0f))) - 1e-6f;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (const std::size_t bit : {std::size_t{1}, std::size_t{2}, std::size_t{4}}) {
      if (i & bit) continue;
      vec3 a = corners[i], b = corners[i | bit];
      if (!camera.orthographic) {
        if (a.z > nearest && b.z > nearest) continue;
        // The part in front of the camera.
        if (a.z > nearest) a = glm::mix(a, b, (nearest - a.z) / (b.z - a.z));
        if (b.z > nearest) b = glm::mix(b, a, (nearest - b.z) / (a.z - b.z));
      }
      lines.emplace_back(projection.toImage(a), projection.toImage(b));
    }
  return lines;
}

}  // namespace quintet::overlay
