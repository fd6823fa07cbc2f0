// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/orbit_camera.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/error.h"
#include "job/view.h"
#include "scene/defaults/auto_camera.h"

namespace quintet::job::interactive {
namespace {

constexpr uvec2 kSize{200, 100};

// At (0, 0, 5), looks at the origin.
OrbitCamera front() {
  return orbitCamera(scene::lookAtCamera({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, kPi / 2.0f, 0.0f), {0, 0, 0});
}

void expectNear(const vec3& a, const vec3& b) {
  EXPECT_LT(glm::length(a - b), 1e-4f) << a.x << " " << a.y << " " << a.z;
}

// Pixel of a point, x right, y down.
vec2 pixelOf(const OrbitCamera& camera, const vec3& point) {
  const vec3 p = glm::inverse(camera.worldFromCamera) * (point - camera.eye());
  const float half = std::tan(0.5f * camera.verticalFov);
  const float aspect = static_cast<float>(kSize.x) / static_cast<float>(kSize.y);
  const vec2 ndc(p.x / (-p.z * half * aspect), p.y / (-p.z * half));
  return 0.5f * vec2(kSize) * vec2(1 + ndc.x, 1 - ndc.y);
}

TEST(OrbitCamera, StartsAtTheCamera) {
  const OrbitCamera camera = front();
  expectNear(camera.eye(), {0, 0, 5});
  expectNear(camera.center, {0, 0, 0});
  const scene::Camera moved = scene::lookAtCamera({0, 0, 5}, {1, 0, 0}, {0, 1, 0}, 1.0f, 0.0f);
  EXPECT_LT(glm::length(orbitCamera(moved, {0, 0, 0}).center - vec3(1, 0, 0)), 0.3f) << "a point on the optical axis";
  expectNear(orbitCamera(moved, {0, 0, 9}).center, {1, 0, 0});  // behind the camera: the point in focus
  scene::Camera orthographic;
  orthographic.orthographic = true;
  EXPECT_THROW(orbitCamera(orthographic, {}), UsageError);
}

// The request gives the camera from which it was made.
TEST(OrbitCamera, RequestsTheSameCamera) {
  scene::Camera camera = scene::lookAtCamera({3, 1, 2}, {0, 0.5f, 0}, {0.3f, 1, 0}, 0.7f, 0.05f);
  camera.focusDistance = 2.5f;
  scene::Scene scene;
  const scene::Camera again = chooseCamera(scene, orbitCamera(camera, {0, 0.5f, 0}).request(), 1.0f).camera;
  for (glm::length_t i = 0; i < 4; ++i)
    EXPECT_LT(glm::length(again.worldFromCamera[i] - camera.worldFromCamera[i]), 1e-5f);
  EXPECT_NEAR(again.verticalFov, camera.verticalFov, 1e-6f);
  EXPECT_EQ(again.apertureRadius, 0.05f);
  EXPECT_EQ(again.focusDistance, 2.5f);
}

TEST(OrbitCamera, OrbitsAroundTheCenter) {
  expectNear(orbit(front(), 90, 0, {}).eye(), {5, 0, 0});
  expectNear(orbit(front(), 0, 90, {}).eye(), {0, 5, 0});
  OrbitCamera camera = front();
  for (int i = 0; i < 12; ++i) camera = orbit(camera, 30, 0, {});
  expectNear(camera.eye(), {0, 0, 5});
  EXPECT_NEAR((orbit(orbit(front(), 0, 30, {}), 77, 0, {}).worldFromCamera * vec3(1, 0, 0)).y, 0.0f, 1e-5f)
      << "no roll";
}

TEST(OrbitCamera, OrbitsAroundAnyPoint) {
  const vec3 pivot(1, 0.5f, -2);
  const OrbitCamera turned = orbit(front(), 25, -15, pivot);
  EXPECT_LT(glm::length(pixelOf(turned, pivot) - pixelOf(front(), pivot)), 1e-2f);
  EXPECT_NEAR(glm::length(turned.eye() - pivot), glm::length(front().eye() - pivot), 1e-4f);
  EXPECT_NEAR(turned.depthOf(pivot), front().depthOf(pivot), 1e-4f);
  EXPECT_GT(glm::length(turned.eye() - front().eye()), 1.0f);
}

TEST(OrbitCamera, PansWithTheCursor) {
  const OrbitCamera camera = orbit(front(), 20, 10, {}), moved = pan(camera, {30, -12}, kSize);
  const vec2 shift = pixelOf(moved, camera.center) - pixelOf(camera, camera.center);
  EXPECT_NEAR(shift.x, 30.0f, 1e-3f);
  EXPECT_NEAR(shift.y, -12.0f, 1e-3f);
}

TEST(OrbitCamera, ZoomKeepsThePixel) {
  const OrbitCamera camera = orbit(front(), 20, 10, {});
  // A point in the plane of the center.
  const vec3 point = camera.center + camera.worldFromCamera * vec3(1.5f, -0.7f, 0);
  const vec2 pixel = pixelOf(camera, point);
  const OrbitCamera closer = zoom(camera, 3, pixel, kSize);
  EXPECT_NEAR(closer.distance, camera.distance / 3, 1e-5f);
  EXPECT_LT(glm::length(pixelOf(closer, point) - pixel), 1e-2f);
  expectNear(zoom(camera, 2, 0.5f * vec2(kSize), kSize).center, camera.center);
}

TEST(OrbitCamera, Flies) {
  expectNear(fly(front(), {1, 2, 3}, 0, 0).eye(), {1, 2, 2});
  const OrbitCamera turned = fly(front(), {0, 0, 0}, 90, 0);
  expectNear(turned.eye(), {0, 0, 5});
  expectNear(turned.worldFromCamera * vec3(0, 0, -1), {-1, 0, 0});
  expectNear(fly(front(), {0, 0, 0}, 0, 90).worldFromCamera * vec3(0, 0, -1), {0, 1, 0});
}

TEST(OrbitCamera, FramesBounds) {
  Bounds3 bounds;
  bounds.extend(vec3(9, -1, 3));
  bounds.extend(vec3(11, 2, 4));
  for (const uvec2 size : {kSize, uvec2(50, 200)}) {
    OrbitCamera camera = frame(orbit(front(), 33, 12, {}), bounds, size);
    expectNear(camera.center, bounds.center());
    const mat3 cameraFromWorld(glm::inverse(camera.worldFromCamera));
    const float half = std::tan(0.5f * camera.verticalFov);
    const float aspect = static_cast<float>(size.x) / static_cast<float>(size.y);
    for (int i = 0; i < 8; ++i) {
      const vec3 corner(i & 1 ? 11 : 9, i & 2 ? 2 : -1, i & 4 ? 4 : 3);
      const vec3 p = cameraFromWorld * (corner - camera.eye());
      EXPECT_LT(std::abs(p.y), -p.z * half);
      EXPECT_LT(std::abs(p.x), -p.z * half * aspect);
    }
  }
  expectNear(frame(front(), Bounds3(), kSize).eye(), front().eye());
}

}  // namespace
}  // namespace quintet::job::interactive
