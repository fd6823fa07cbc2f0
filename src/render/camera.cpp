// scene::Camera to the device's form.
#include <cmath>

#include "render/renderer.h"

namespace quintet::render {

shared::CameraData makeCamera(const scene::Camera& camera, std::uint32_t width, std::uint32_t height) {
  shared::CameraData data{};
  const mat4 rows = glm::transpose(camera.worldFromCamera);
  for (int i = 0; i < 3; ++i) data.worldFromCamera[i] = rows[i];
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  if (camera.orthographic) {
    // The file's box fits into the image; the longer side of the image shows more.
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

}  // namespace quintet::render
