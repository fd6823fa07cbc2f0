// SPDX-License-Identifier: Apache-2.0
#include "job/depth_map.h"

#include <cmath>
#include <functional>
#include <utility>

#include <gtest/gtest.h>

#include "base/file.h"
#include "job/observer.h"
#include "job/render_job.h"
#include "job/test_engine.h"
#include "program/load.h"
#include "temp_folder.h"

namespace quintet::job {
namespace {

// A wall of 6 m at z = 0 behind a small one at z = 2, both seen from z = 4.
constexpr const char* kScene = R"(
[[mesh]]
name = "wall"
positions = [[-3, -3, 0], [3, -3, 0], [3, 3, 0], [-3, 3, 0]]
indices = [[0, 1, 2], [0, 2, 3]]
[[mesh]]
name = "plate"
positions = [[0, 0, 2], [1, 0, 2], [1, 1, 2], [0, 1, 2]]
indices = [[0, 1, 2], [0, 2, 3]]
[[instance]]
of = "wall"
[[instance]]
of = "plate"
[[camera]]
name = "pinhole"
look_from = [0, 0, 4]
look_at = [0, 0, 0]
fov = 90
)";

constexpr uvec2 kSize{32, 16};

class DepthMapTest : public testing::Test {
 protected:
  DepthMapTest() { writeFile(folder_ / "walls.scene.toml", kScene); }

  DepthMap depthOf(const char* programName, const std::function<void(scene::Camera&)>& change = {}) {
    const program::Program program = program::loadProgram(programName);
    RenderRequest request;
    request.scene = folder_ / "walls.scene.toml";
    request.size = kSize;
    Observer observer;
    RenderJob job(testEngine(), resolve(std::move(request), program), observer);
    scene::Camera camera = job.camera();
    if (change) change(camera);
    return renderDepthMap(testEngine(), *job.scene()->onDevice, camera, kSize, program);
  }
  static float at(const DepthMap& map, std::uint32_t x, std::uint32_t y) { return map.depths[y * map.size.x + x]; }

  test::TempFolder folder_;
};

TEST_F(DepthMapTest, HoldsDepthsAlongTheAxis) {
  const DepthMap map = depthOf("normals");
  ASSERT_EQ(map.depths.size(), 512u);
  // The image shows 16 m × 8 m at the wall.
  EXPECT_NEAR(at(map, 15, 9), 4.0f, 1e-4f) << "the middle";
  EXPECT_NEAR(at(map, 10, 13), 4.0f, 1e-4f) << "not the length of the ray";
  EXPECT_NEAR(at(map, 17, 6), 2.0f, 1e-4f) << "the plate, up and to the right";
  EXPECT_EQ(at(map, 1, 8), 0.0f) << "beside the wall";
}

TEST_F(DepthMapTest, SupportsOrthographicCamerasAndLenses) {
  const DepthMap box = depthOf("normals", [](scene::Camera& camera) {
    camera.orthographic = true;
    camera.orthographicHalfSize = {8.0f, 4.0f};
  });
  EXPECT_NEAR(at(box, 10, 13), 4.0f, 1e-4f);
  EXPECT_NEAR(at(box, 17, 6), 2.0f, 1e-4f);
  EXPECT_EQ(at(box, 1, 8), 0.0f);
  const DepthMap lens = depthOf("normals", [](scene::Camera& camera) { camera.apertureRadius = 0.5f; });
  EXPECT_NEAR(at(lens, 17, 6), 2.0f, 1e-4f) << "the lens is replaced by its center";
  EXPECT_NEAR(at(lens, 10, 13), 4.0f, 1e-4f);
}

// A plane that slopes in both directions, close to the camera, shows where the ray of each pixel is.
TEST_F(DepthMapTest, HoldsTheDepthsOfPixelCenters) {
  writeFile(folder_ / "walls.scene.toml", R"(
[[mesh]]
name = "slope"
positions = [[-9, -9, -9.9], [9, -9, 4.5], [9, 9, 9.9], [-9, 9, -4.5]]
indices = [[0, 1, 2], [0, 2, 3]]
[[instance]]
of = "slope"
[[camera]]
name = "pinhole"
look_from = [0, 0, 0.2]
look_at = [0, 0, 0]
fov = 45
)");
  const DepthMap map = depthOf("normals");
  const float half = std::tan(0.125f * 3.14159265f);
  for (std::uint32_t y = 0; y < kSize.y; ++y)
    for (std::uint32_t x = 0; x < kSize.x; ++x) {
      const vec2 size(kSize), center = vec2(x, y) + 0.5f, p = half / size.y * vec2(2, -2) * (center - 0.5f * size);
      // z = 0.8 x + 0.3 y meets z = 0.2 - d at x, y = p d.
      EXPECT_NEAR(at(map, x, y), 0.2f / (1.0f + 0.8f * p.x + 0.3f * p.y), 1e-5f) << x << " " << y;
    }
  const DepthMap lens = depthOf("normals", [](scene::Camera& camera) { camera.apertureRadius = 0.05f; });
  for (std::size_t i = 0; i < map.depths.size(); ++i)
    EXPECT_NEAR(lens.depths[i], map.depths[i], 1e-5f) << "the lens is replaced by its center";
}

// The samples of a blurred image leave the scene at other times.
TEST_F(DepthMapTest, ShowsTheMiddleOfTheShutter) {
  std::string text = kScene;
  text.replace(text.rfind("[[camera]]"), 0,
               "keyframes = [{ frame = 0, translate = [0, 0, -1] }, { frame = 10, translate = [0, 0, 0] }]\n");
  text += "keyframes = [{ frame = 0 }, { frame = 10, look_from = [0, 0, 6] }]\n";
  writeFile(folder_ / "walls.scene.toml", text);
  RenderRequest request;
  request.scene = folder_ / "walls.scene.toml";
  request.size = kSize;
  request.limits.samples = 3;
  request.shutter = ShutterRequest{0, 10};
  Observer observer;
  RenderJob job(testEngine(), resolve(request, program::loadProgram("normals")), observer);
  job.run(request.limits, observer);
  const DepthMap map = renderDepthMap(testEngine(), job);
  EXPECT_NEAR(map.camera.worldFromCamera[3].z, 5.0f, 1e-4f);
  EXPECT_NEAR(at(map, 17, 6), 3.5f, 1e-4f) << "the plate at z = 1.5";
  EXPECT_NEAR(at(map, 13, 11), 5.0f, 1e-4f) << "the wall";
}

// The scene is prepared for a program with one ray type.
TEST_F(DepthMapTest, FitsTheSceneOfEveryProgram) { EXPECT_NEAR(at(depthOf("lessons/04_diffuse"), 17, 6), 2.0f, 1e-4f); }

}  // namespace
}  // namespace quintet::job
