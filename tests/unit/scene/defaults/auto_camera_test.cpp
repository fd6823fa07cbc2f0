// SPDX-License-Identifier: Apache-2.0
// The automatic camera frames all bounds tightly and is always finite.
#include "scene/defaults/auto_camera.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace quintet::test {
namespace {

// Extent of the corners in the image, as a fraction of its half size; y up.
struct Frame {
  vec2 low{1e9f}, high{-1e9f};
  float nearest = 1e30f;
};

Frame project(const scene::Camera& camera, const Bounds3& bounds, float aspect) {
  Frame frame;
  const glm::dmat4 cameraFromWorld = glm::inverse(glm::dmat4(camera.worldFromCamera));
  const double slope = std::tan(camera.verticalFov / 2.0);
  for (int i = 0; i < 8; ++i) {
    const glm::dvec4 corner(i & 1 ? bounds.max.x : bounds.min.x, i & 2 ? bounds.max.y : bounds.min.y,
                            i & 4 ? bounds.max.z : bounds.min.z, 1);
    const glm::dvec4 p = cameraFromWorld * corner;
    const vec2 screen(p.x / (-p.z * slope * aspect), p.y / (-p.z * slope));
    frame.low = glm::min(frame.low, screen), frame.high = glm::max(frame.high, screen);
    frame.nearest = std::min(frame.nearest, static_cast<float>(-p.z));
  }
  return frame;
}

void expectGoodFrame(const Bounds3& bounds, float aspect) {
  SCOPED_TRACE(testing::Message() << bounds.min.x << " … " << bounds.max.x << " " << aspect);
  const scene::Camera camera = scene::frameScene(bounds, aspect);
  const Frame frame = project(camera, bounds, aspect);
  EXPECT_GT(frame.nearest, 0.0f);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    EXPECT_LE(frame.high[axis], 0.99f);
    EXPECT_GE(frame.low[axis], -0.99f);
    EXPECT_NEAR(frame.high[axis] + frame.low[axis], 0.0f, 0.02f);  // centered
  }
  EXPECT_GT(std::max(frame.high.x, frame.high.y), 0.93f);  // tight on at least one axis
  EXPECT_GT(camera.focusDistance, 0.0f);
  EXPECT_FALSE(camera.orthographic);
  EXPECT_NEAR(glm::determinant(mat3(camera.worldFromCamera)), 1.0f, 1e-4f);
  EXPECT_GT(camera.worldFromCamera[2].y, 0.0f);  // looks down
  EXPECT_GT(camera.worldFromCamera[2].z, 0.0f);  // from the front
}

TEST(AutoCamera, FramesBoundsOfAllShapes) {
  for (const float aspect : {0.4f, 1.0f, 16.0f / 9.0f, 3.5f})
    for (const vec3& half : {vec3(1), vec3(10, 1, 1), vec3(1, 10, 1), vec3(1, 1, 10), vec3(5, 5, 0), vec3(5, 0, 5)})
      for (const float scale : {1e-3f, 1.0f, 1e5f})
        expectGoodFrame({scale * (vec3(3, -2, 1) - half), scale * (vec3(3, -2, 1) + half)}, aspect);
}

TEST(AutoCamera, StaysFinite) {
  const float huge = std::numeric_limits<float>::max(), inf = std::numeric_limits<float>::infinity();
  const Bounds3 cases[] = {{},
                           {vec3(0), vec3(0)},
                           {vec3(7, 8, 9), vec3(7, 8, 9)},
                           {vec3(-huge), vec3(huge)},
                           {vec3(-inf), vec3(inf)},
                           {vec3(0), vec3(1e-38f)}};
  for (const Bounds3& bounds : cases)
    for (const float aspect : {1.5f, 0.0f, -1.0f, inf, std::numeric_limits<float>::quiet_NaN()}) {
      const scene::Camera camera = scene::frameScene(bounds, aspect);
      for (std::size_t column = 0; column < 4; ++column) EXPECT_TRUE(isFinite(vec3(camera.worldFromCamera[column])));
      EXPECT_TRUE(std::isfinite(camera.focusDistance));
      EXPECT_GT(camera.focusDistance, 0.0f);
    }
}

}  // namespace
}  // namespace quintet::test
