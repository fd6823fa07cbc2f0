// SPDX-License-Identifier: Apache-2.0
#include "overlay/camera_projection.h"

#include "render/scene/camera.h"

namespace quintet::overlay {

CameraProjection::CameraProjection(const scene::Camera& camera, uvec2 size)
    : cameraFromWorld_(glm::inverse(camera.worldFromCamera)),
      halfSize_(render::makeCamera(camera, size.x, size.y).halfSize),
      size_(size),
      orthographic_(camera.orthographic) {}

vec2 CameraProjection::toImage(const vec3& point) const {
  const vec2 plane = (orthographic_ ? vec2(point) : vec2(point) / -point.z) / halfSize_;
  return (0.5f + 0.5f * plane * vec2(1.0f, -1.0f)) * size_;
}

}  // namespace quintet::overlay
