// SPDX-License-Identifier: Apache-2.0
// Rays over the image of a scene with a wall: before it, behind it, selected.
#include "overlay/ray_image.h"

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "job/depth_map.h"
#include "job/observer.h"
#include "job/render_job.h"
#include "job/test_engine.h"
#include "overlay/line_image.h"
#include "overlay/ray_overlay.h"
#include "program/load.h"
#include "temp_folder.h"

namespace quintet::overlay {
namespace {

using testing::HasSubstr;

// A wall at z = 0 that fills the lower half of the image; the camera looks at it from z = 4.
constexpr const char* kRayScene = R"(
[[mesh]]
name = "wall"
positions = [[-9, -9, 0], [9, -9, 0], [9, 0, 0], [-9, 0, 0]]
indices = [[0, 1, 2], [0, 2, 3]]
[[instance]]
of = "wall"
[[camera]]
look_from = [0, 0, 4]
look_at = [0, 0, 0]
fov = 90
)";

constexpr uvec2 kRayImageSize{96, 64};

job::ExplainedEvent ray(const vec3& from, const vec3& direction, float tmax) {
  return {"ray",
          {{"rayType", std::string("shadow")},
           {"flags", std::string()},
           {"origin", std::vector<float>{from.x, from.y, from.z}},
           {"direction", std::vector<float>{direction.x, direction.y, direction.z}},
           {"tmax", tmax},
           {"result", std::string("miss")}},
          {}};
}

// Horizontal lines across the image: before the wall, behind it, and behind where nothing hides it.
job::PixelExplanation threeLines() {
  job::PixelExplanation e;
  e.events = {ray({-2, -1, 1}, {1, 0, 0}, 4), ray({-4, -4, -2}, {1, 0, 0}, 8), ray({-4, 4, -2}, {1, 0, 0}, 8)};
  return e;
}

class RayImageTest : public testing::Test {
 protected:
  RayImageTest() { writeFile(folder_ / "wall.scene.toml", kRayScene); }

  std::unique_ptr<job::RenderJob> makeJob() {
    job::RenderRequest request;
    request.scene = folder_ / "wall.scene.toml";
    request.size = kRayImageSize;
    request.limits.samples = 4;
    return std::make_unique<job::RenderJob>(
        job::testEngine(), job::resolve(std::move(request), program::loadProgram("normals")), observer_);
  }

  static io::Image black() {
    return io::makeImage(kRayImageSize.x, kRayImageSize.y, 3, io::PixelType::u8, io::ColorEncoding::sRgb);
  }
  // Sum of the red values in the rows around the projection of a height in a plane, without the ends of the line.
  static int brightness(const io::Image& image, float y, float depth) {
    const float row = 32.0f - 32.0f * y / depth;
    int sum = 0;
    for (int dy = -3; dy <= 3; ++dy)
      for (std::uint32_t x = 40; x < 56; ++x)
        sum += image.pixel<std::uint8_t>(x, static_cast<std::uint32_t>(row + static_cast<float>(dy)))[0];
    return sum;
  }

  test::TempFolder folder_;
  job::Observer observer_;
};

TEST_F(RayImageTest, DrawsHiddenRaysFaintly) {
  const auto job = makeJob();
  const job::DepthMap depth = job::renderDepthMap(job::testEngine(), *job->scene()->onDevice, job->camera(),
                                                  kRayImageSize, job->resolved().program);
  const io::Image image = drawRays(job::testEngine().context(), threeLines(), depth, black(), {});
  const int before = brightness(image, -1, 3), behind = brightness(image, -4, 6), free = brightness(image, 4, 6);
  EXPECT_GT(before, 16 * 200);
  EXPECT_NEAR(free, before, 0.2 * before) << "nothing hides it";
  EXPECT_GT(behind, 0.08 * before);
  EXPECT_LT(behind, 0.4 * before);
}

TEST_F(RayImageTest, EmphasizesTheSelectedRay) {
  const auto job = makeJob();
  const job::DepthMap depth = job::renderDepthMap(job::testEngine(), *job->scene()->onDevice, job->camera(),
                                                  kRayImageSize, job->resolved().program);
  const RayOverlay overlay = rayOverlay(threeLines(), 1.0f);
  OverlayView view{job->camera(), {}};
  view.placement.size = kRayImageSize;
  const WindowShaders shaders = compileLineShaders({});
  std::array<io::Image, 2> images;
  for (std::size_t i = 0; i < 2; ++i) {
    OverlayStyle style;
    if (i == 1) style.selected = 2;
    images[i] = drawLines(job::testEngine().context(), shaders, black(), overlayLines(overlay, view, style, &depth),
                          kRayImageSize, reversedDepths(depth));
  }
  EXPECT_GT(brightness(images[1], 4, 6), 1.5 * brightness(images[0], 4, 6)) << "wider";
  EXPECT_LT(brightness(images[1], -1, 3), 0.6 * brightness(images[0], -1, 3)) << "the others are faint";
}

TEST_F(RayImageTest, RequiresTheCameraOfTheScene) {
  const auto job = makeJob();
  job::PixelExplanation e;
  e.program = "fish eye";
  e.size = kRayImageSize;
  e.pixel = {48, 32};
  e.events = {ray({0, 0, 4}, glm::normalize(vec3(0.5f / 32, -0.5f / 32, -1)), 4)};
  e.events[0].set("rayType", std::string("radiance"));
  EXPECT_NO_THROW(requireSceneCamera(e, job->camera()));
  e.pixel = {10, 32};
  try {
    requireSceneCamera(e, job->camera());
    ADD_FAILURE() << "the ray is that of a different pixel";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("fish eye: the first ray of pixel 10,32 is not that of the scene's camera"));
  }
}

}  // namespace
}  // namespace quintet::overlay
