// SPDX-License-Identifier: Apache-2.0
#include "render/scene/camera.h"

#include <cmath>

namespace quintet::render {

shared::CameraData makeCamera(const scene::Camera& camera, std::uint32_t width, std::uint32_t height) {
  shared::CameraData data{};
  const mat4 rows = glm::transpose(camera.worldFromCamera);
  for (int i = 0; i < 3; ++i) data.worldFromCamera[i] = rows[i];
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  if (camera.orthographic) {
    // The camera's box fits into the image, which shows more along its longer side.
    vec2 half = camera.orthographicHalfSize;
    if (half.x < half.y * aspect)
      half.x = half.y * aspect;
    else
      half.y = half.x / aspect;
    data.halfSize = half;
  } else {
    const float half = std::tan(0.5f * camera.verticalFov);
    data.halfSize = {half * aspect, half};
  }
  data.apertureRadius = camera.apertureRadius;
  data.focusDistance = camera.focusDistance;
  data.orthographic = camera.orthographic ? 1 : 0;
  return data;
}

// Computed in double precision, because a camera far from the origin has large terms that cancel.
CameraMatrices cameraMatrices(const scene::Camera& camera, std::uint32_t width, std::uint32_t height) {
  const vec2 half = makeCamera(camera, width, height).halfSize;
  glm::dmat4 cameraFromWorld = glm::inverse(glm::dmat4(camera.worldFromCamera));
  for (std::size_t column = 0; column < 4; ++column) cameraFromWorld[column].z = -cameraFromWorld[column].z;
  glm::dmat4 ndcFromCamera(1.0);  // columns
  ndcFromCamera[0].x = 0.5 / static_cast<double>(half.x);
  ndcFromCamera[1].y = -0.5 / static_cast<double>(half.y);
  if (camera.orthographic) {
    ndcFromCamera[3] = {0.5, 0.5, 0.0, 1.0};
  } else {
    ndcFromCamera[2] = {0.5, 0.5, 1.0, 1.0};
    ndcFromCamera[3] = {0.0, 0.0, -1.0, 0.0};
  }
  return {mat4(cameraFromWorld), mat4(ndcFromCamera * cameraFromWorld)};
}

}  // namespace quintet::render
