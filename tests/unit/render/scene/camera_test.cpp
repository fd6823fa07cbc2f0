// SPDX-License-Identifier: Apache-2.0
// The camera's matrices for other programs, as OpenEXR's own accessors and Imath apply them to points.
#include "render/scene/camera.h"

#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/file.h"
#include "io/exr/exr.h"
#include "temp_folder.h"

namespace quintet::render {
namespace {

constexpr std::uint32_t kWidth = 60, kHeight = 35;

// The meaning of worldToCamera and worldToNDC, computed from the axes of the camera.
struct Expected {
  vec3 camera;
  vec2 ndc;
};

Expected project(const scene::Camera& camera, const vec3& world) {
  const mat4& m = camera.worldFromCamera;
  const vec3 toPoint = world - vec3(m[3]);
  const vec3 p{glm::dot(toPoint, vec3(m[0])), glm::dot(toPoint, vec3(m[1])), -glm::dot(toPoint, vec3(m[2]))};
  const float aspect = float{kWidth} / float{kHeight};
  float halfHeight = std::tan(0.5f * camera.verticalFov) * p.z;  // half the height of the image at that depth
  // The box of the camera fits into the image.
  if (camera.orthographic) halfHeight = std::max(camera.orthographicHalfSize.y, camera.orthographicHalfSize.x / aspect);
  return {p, {0.5f + 0.5f * p.x / (halfHeight * aspect), 0.5f - 0.5f * p.y / halfHeight}};
}

class CameraMatricesTest : public testing::Test {
 protected:
  std::minstd_rand random_{5};
  float uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }

  scene::Camera camera(bool orthographic) {
    scene::Camera camera;
    camera.orthographic = orthographic;
    camera.verticalFov = uniform(0.2f, 2.0f);
    camera.orthographicHalfSize = {uniform(0.5f, 3.0f), uniform(0.5f, 3.0f)};
    const vec3 eye{uniform(-5, 5), uniform(-5, 5), uniform(-5, 5)};
    const vec3 at{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    camera.worldFromCamera = glm::inverse(glm::lookAt(eye, at, vec3(uniform(-1, 1), 1, 0)));
    camera.apertureRadius = uniform(0, 1);  // has no effect
    return camera;
  }

  // Writes the matrices to a file, and reads them with OpenEXR's accessors.
  std::pair<Imath::M44f, Imath::M44f> written(const scene::Camera& camera) {
    const CameraMatrices matrices = cameraMatrices(camera, kWidth, kHeight);
    io::ExrImage image{1, 1, {{"R", io::ExrType::half, {0.0f}}}};
    image.attributes = {{"worldToCamera", matrices.cameraFromWorld}, {"worldToNDC", matrices.ndcFromWorld}};
    const auto file = folder_ / "a.exr";
    writeFile(file, io::encodeExr(image));
    const Imf::InputFile input(file.c_str());
    return {Imf::worldToCamera(input.header()), Imf::worldToNDC(input.header())};
  }

  test::TempFolder folder_;
};

TEST_F(CameraMatricesTest, MatchesTheStandard) {
  for (int i = 0; i < 40; ++i) {
    const scene::Camera camera = this->camera(i % 2 == 0);
    const auto [toCamera, toNdc] = written(camera);
    EXPECT_NEAR(toCamera.determinant(), -1.0f, 1e-5f);  // left-handed, without scale
    for (int k = 0; k < 20; ++k) {
      const vec3 inFront{uniform(-2, 2), uniform(-2, 2), -uniform(0.3f, 9)};
      const vec3 world = vec3(camera.worldFromCamera * vec4(inFront, 1));
      const Expected expected = project(camera, world);
      const Imath::V3f p = Imath::V3f(world.x, world.y, world.z) * toCamera;  // divides by w
      EXPECT_NEAR(p.x, inFront.x, 1e-4f);
      EXPECT_NEAR(p.y, inFront.y, 1e-4f);
      EXPECT_NEAR(p.z, -inFront.z, 1e-4f);
      EXPECT_NEAR(p.z, expected.camera.z, 1e-4f);
      const Imath::V3f ndc = Imath::V3f(world.x, world.y, world.z) * toNdc;
      const float tolerance = 1e-4f * (1 + std::abs(expected.ndc.x) + std::abs(expected.ndc.y));
      EXPECT_NEAR(ndc.x, expected.ndc.x, tolerance);
      EXPECT_NEAR(ndc.y, expected.ndc.y, tolerance);
      EXPECT_NEAR(ndc.z, camera.orthographic ? p.z : 1 - 1 / p.z, 1e-4f * (1 + 1 / p.z));
    }
  }
}

// A camera that looks along -z from (0, 0, 4), where the image extends 2 m to each side at the origin.
TEST_F(CameraMatricesTest, MapsCornersOfTheImage) {
  for (const bool orthographic : {false, true}) {
    scene::Camera camera;
    camera.orthographic = orthographic;
    camera.verticalFov = 2 * std::atan(0.5f);
    camera.orthographicHalfSize = {2, 2};
    camera.worldFromCamera[3] = {0, 0, 4, 1};
    const mat4 ndc = cameraMatrices(camera, 10, 10).ndcFromWorld;
    const auto at = [&](float x, float y) {
      const vec4 p = ndc * vec4(x, y, 0, 1);
      return vec2(p) / p.w;
    };
    for (const auto& [world, wanted] : {std::pair(vec2(-2, 2), vec2(0, 0)), std::pair(vec2(2, 2), vec2(1, 0)),
                                        std::pair(vec2(-2, -2), vec2(0, 1)), std::pair(vec2(1, 0), vec2(0.75f, 0.5f))})
      EXPECT_LT(glm::distance(at(world.x, world.y), wanted), 1e-6f) << orthographic << world.x << world.y;
  }
}

// The terms cancel for a camera far from the origin.
TEST_F(CameraMatricesTest, IsPreciseFarFromTheOrigin) {
  scene::Camera camera = this->camera(false);
  camera.worldFromCamera[3] = {30000, -20000, 1000, 1};
  const vec3 world = vec3(camera.worldFromCamera * vec4(1, -1, -8, 1));
  const Expected expected = project(camera, world);
  const vec4 p = cameraMatrices(camera, kWidth, kHeight).ndcFromWorld * vec4(world, 1);
  EXPECT_NEAR(p.x / p.w, expected.ndc.x, 5e-3f);
  EXPECT_NEAR(p.y / p.w, expected.ndc.y, 5e-3f);
}

}  // namespace
}  // namespace quintet::render
