// SPDX-License-Identifier: Apache-2.0
#include "overlay/box_outline.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace quintet::overlay {
namespace {

constexpr uvec2 kImage{200, 100};

scene::Camera cameraAt(const vec3& position) {
  scene::Camera camera;
  camera.verticalFov = glm::radians(90.0f);
  camera.worldFromCamera[3] = vec4(position, 1.0f);
  return camera;
}

Bounds3 unitBox() {
  Bounds3 bounds;
  bounds.extend(vec3(-1));
  bounds.extend(vec3(1));
  return bounds;
}

TEST(BoxOutline, ProjectsTheEdges) {
  const std::vector<ImageLine> lines = boxOutline(cameraAt({0, 0, 3}), kImage, unitBox(), mat4(1.0f));
  ASSERT_EQ(lines.size(), 12u);
  // The near face is 2 m away: half a meter of the image's half height per meter.
  vec2 least(1e9f), most(-1e9f);
  for (const auto& [a, b] : lines) {
    least = glm::min(least, glm::min(a, b));
    most = glm::max(most, glm::max(a, b));
  }
  EXPECT_NEAR(least.x, 75.0f, 1e-3f);
  EXPECT_NEAR(most.x, 125.0f, 1e-3f);
  EXPECT_NEAR(least.y, 25.0f, 1e-3f);
  EXPECT_NEAR(most.y, 75.0f, 1e-3f);
}

TEST(BoxOutline, AppliesTheTransform) {
  mat4 moved(1.0f);
  moved[3] = {4, 0, 0, 1};
  for (const auto& [a, b] : boxOutline(cameraAt({0, 0, 3}), kImage, unitBox(), moved)) {
    EXPECT_GT(a.x, 125.0f);
    EXPECT_GT(b.x, 125.0f);
  }
}

TEST(BoxOutline, ClipsEdgesBehindTheCamera) {
  EXPECT_TRUE(boxOutline(cameraAt({0, 0, -3}), kImage, unitBox(), mat4(1.0f)).empty()) << "all behind";
  const std::vector<ImageLine> inside = boxOutline(cameraAt({0, 0, 0.5f}), kImage, unitBox(), mat4(1.0f));
  EXPECT_EQ(inside.size(), 8u) << "the edges of the near face are behind the camera";
  for (const auto& [a, b] : inside) EXPECT_TRUE(std::isfinite(a.x + a.y + b.x + b.y));
}

TEST(BoxOutline, SupportsOrthographicCameras) {
  scene::Camera camera = cameraAt({0, 0, 3});
  camera.orthographic = true;
  camera.orthographicHalfSize = {4, 2};
  const std::vector<ImageLine> lines = boxOutline(camera, kImage, unitBox(), mat4(1.0f));
  ASSERT_EQ(lines.size(), 12u);
  for (const auto& [a, b] : lines) {
    EXPECT_NEAR(std::abs(a.x - 100.0f), 25.0f, 1e-3f);
    EXPECT_NEAR(std::abs(b.y - 50.0f), 25.0f, 1e-3f);
  }
}

TEST(BoxOutline, IsEmptyWithoutABoxOrAnImage) {
  EXPECT_TRUE(boxOutline(cameraAt({0, 0, 3}), kImage, {}, mat4(1.0f)).empty());
  EXPECT_TRUE(boxOutline(cameraAt({0, 0, 3}), {0, 0}, unitBox(), mat4(1.0f)).empty());
}

}  // namespace
}  // namespace quintet::overlay
