// SPDX-License-Identifier: Apache-2.0
#include "overlay/camera_projection.h"

#include <gtest/gtest.h>

namespace quintet::overlay {
namespace {

constexpr uvec2 kProjected{200, 100};

scene::Camera turnedCamera() {
  scene::Camera camera;
  camera.verticalFov = glm::radians(90.0f);
  camera.orthographicHalfSize = {3.0f, 2.0f};
  camera.worldFromCamera = glm::rotate(glm::translate(mat4(1.0f), {1, 2, 3}), 0.7f, glm::normalize(vec3(1, 2, 0.5f)));
  return camera;
}

vec3 worldOf(const scene::Camera& camera, const vec3& point) { return camera.worldFromCamera * vec4(point, 1.0f); }

TEST(CameraProjection, ProjectsPointsOfAPerspectiveCamera) {
  const scene::Camera camera = turnedCamera();
  const CameraProjection projection(camera, kProjected);
  const vec3 point = projection.toCamera(worldOf(camera, {1.0f, -2.0f, -4.0f}));
  EXPECT_NEAR(point.x, 1.0f, 1e-5f);
  EXPECT_NEAR(point.z, -4.0f, 1e-5f);
  // At 4 m, the image is 16 m wide and 8 m high.
  EXPECT_NEAR(projection.toImage(point).x, 112.5f, 1e-3f);
  EXPECT_NEAR(projection.toImage(point).y, 75.0f, 1e-3f);
  EXPECT_FLOAT_EQ(projection.pixelSize(4.0f), 0.08f);
}

// As rays of the device's camera, whose box fits into the image.
TEST(CameraProjection, ShowsTheWholeBoxOfAnOrthographicCamera) {
  scene::Camera camera = turnedCamera();
  camera.orthographic = true;
  const CameraProjection projection(camera, kProjected);
  const vec2 corner = projection.toImage({3.0f, 2.0f, -9.0f});
  EXPECT_NEAR(corner.x, 175.0f, 1e-3f);  // the image is 8 m wide
  EXPECT_NEAR(corner.y, 0.0f, 1e-3f);
  EXPECT_FLOAT_EQ(projection.pixelSize(9.0f), 0.04f);
}

// The depths of points on a line are linear in their positions in the image.
TEST(CameraProjection, ReversesDepthsLinearly) {
  for (const bool orthographic : {false, true}) {
    scene::Camera camera = turnedCamera();
    camera.orthographic = orthographic;
    const CameraProjection projection(camera, kProjected);
    const vec3 a(-1.0f, 0.5f, -1.0f), b(2.0f, 1.0f, -7.0f);
    const vec2 from = projection.toImage(a), to = projection.toImage(b);
    for (const float t : {0.1f, 0.4f, 0.9f}) {
      const vec3 point = glm::mix(a, b, t);
      const float s = glm::length(projection.toImage(point) - from) / glm::length(to - from);
      EXPECT_NEAR(glm::mix(projection.reversedDepth(1.0f), projection.reversedDepth(7.0f), s),
                  projection.reversedDepth(-point.z), 1e-4f);
    }
    EXPECT_GT(projection.reversedDepth(1.0f), projection.reversedDepth(2.0f));
  }
}

}  // namespace
}  // namespace quintet::overlay
