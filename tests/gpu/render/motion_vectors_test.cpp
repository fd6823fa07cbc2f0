// SPDX-License-Identifier: Apache-2.0
// The output `motion` of the path tracer: the motion of each visible point in the image since the previous frame, against
// vertices and cameras that the host poses (scene/animation/pose.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "harness.h"
#include "render/scene/camera.h"
#include "rendered_image.h"
#include "scene/animation/pose.h"
#include "scene/gltf_animation.h"
#include "scene/toml/scene_toml.h"

namespace quintet::test {
namespace {

constexpr std::uint32_t kMotionSize = 20;  // pixels in both directions
using MovingCamera = std::function<scene::Camera(double frame)>;

struct MotionLayers {
  std::vector<vec4> motion, position, primitive;
};

class MotionShot {
 public:
  MotionShot(const scene::Scene& scene, MovingCamera camera)
      : device_(testContext(), scene::Scene(scene), scene::Environment{}),
        camera_(std::move(camera)),
        renderer_(makeRenderer(device_, program::loadProgram("pathtracer"), settings(camera_))) {}

  MotionLayers at(double frame, const std::optional<render::ShutterInterval>& shutter = {}) {
    device_.setFrame(frame);
    renderer_.setCamera(camera_(frame));
    renderer_.setShutter(shutter, camera_);
    renderer_.renderBatch();
    return {plane("motion"), plane("position"), plane("primitive_id")};
  }

  // Returns the number of rays of the batch that at() has rendered, and of one more.
  std::uint64_t raysOfTwoBatches() {
    renderer_.renderBatch();
    return renderer_.rays().rays;
  }

 private:
  static render::RenderSettings settings(const MovingCamera& camera) {
    ImageOptions options;
    options.width = options.height = kMotionSize;
    options.set = {"bounces=0"};
    render::RenderSettings settings = settingsFor(camera(0), options);
    settings.outputs = {"motion", "position", "primitive_id"};
    settings.cameraAt = camera;
    return settings;
  }
  std::vector<vec4> plane(const std::string& name) const {
    const std::vector<std::string> names = program::outputNames(renderer_.program());
    return renderer_.film().plane(static_cast<std::size_t>(std::ranges::find(names, name) - names.begin())).values;
  }

  render::DeviceScene device_;
  MovingCamera camera_;
  render::Renderer renderer_;
};

// In pixels, x right, y down.
vec2 projected(const scene::Camera& camera, const vec3& world) {
  const vec4 p = render::cameraMatrices(camera, kMotionSize, kMotionSize).ndcFromWorld * vec4(world, 1.0f);
  return static_cast<float>(kMotionSize) / p.w * vec2(p);
}

// The first mesh of the scene at a frame; it has one geometry and one instance.
std::vector<vec3> worldPositions(scene::Scene scene, double frame) {
  scene::applyPose(scene, scene::poseAt(scene.nodeAnimation.get(), frame));
  std::vector<vec3> positions = scene.meshes[0].geometries[0].positions;
  for (vec3& p : positions) p = vec3(scene.instances[0].worldFromObject * vec4(p, 1.0f));
  return positions;
}

// Where a point of a triangle is after its corners have moved.
vec3 carried(const vec3& point, const vec3 (&from)[3], const vec3 (&to)[3]) {
  const vec3 normal = glm::cross(from[1] - from[0], from[2] - from[0]);
  const float area = glm::dot(normal, normal);
  const float b1 = glm::dot(glm::cross(point - from[0], from[2] - from[0]), normal) / area;
  const float b2 = glm::dot(glm::cross(from[1] - from[0], point - from[0]), normal) / area;
  return (1.0f - b1 - b2) * to[0] + b1 * to[1] + b2 * to[2];
}

// Compares all pixels that show the mesh with the poses of the host at a frame and one frame earlier. Returns the largest
// motion in pixels.
float expectHostMotion(const MotionLayers& layers, const scene::Scene& scene, const MovingCamera& camera,
                       double frame) {
  const std::vector<vec3> now = worldPositions(scene, frame), before = worldPositions(scene, frame - 1);
  float largest = 0;
  int compared = 0;
  for (std::size_t i = 0; i < layers.motion.size(); ++i) {
    if (layers.primitive[i].x == 0.0f) {
      EXPECT_EQ(layers.motion[i].x, 0.0f) << i;
      continue;
    }
    const uvec3 corners = scene.meshes[0].geometries[0].triangles[static_cast<std::size_t>(layers.primitive[i].x) - 1];
    const vec3 to[3] = {before[corners.x], before[corners.y], before[corners.z]};
    const vec3 from[3] = {now[corners.x], now[corners.y], now[corners.z]};
    const vec3 point(layers.position[i]);
    const vec2 moved = projected(camera(frame), point) - projected(camera(frame - 1), carried(point, from, to));
    EXPECT_NEAR(layers.motion[i].x, moved.x, 2e-3) << i;
    EXPECT_NEAR(layers.motion[i].y, -moved.y, 2e-3) << i;
    largest = std::max(largest, glm::length(moved));
    ++compared;
  }
  EXPECT_GT(compared, 10);
  return largest;
}

MovingCamera standing(const scene::Camera& camera) {
  return [camera](double) { return camera; };
}

TEST(MotionVectors, FollowSkins) {
  const scene::Scene scene = bendingStrip(2).loadAnimated();
  const MovingCamera camera = standing(orthographic({0, 1, 5}, {0, 1, 0}, 1.5f));
  MotionShot shot(scene, camera);
  for (const double frame : {12.0, 20.5, 3.0}) {
    EXPECT_GT(expectHostMotion(shot.at(frame), scene, camera, frame), 0.3f) << frame;
  }
  EXPECT_LT(expectHostMotion(shot.at(40), scene, camera, 40), 1e-3f) << "the animation has ended";
}

TEST(MotionVectors, FollowMorphTargets) {
  const scene::Scene scene = morphingTriangle().loadAnimated();
  const MovingCamera camera = standing(perspective({3, 2, 4}, {0.5f, 1, 0}, 30));
  MotionShot shot(scene, camera);
  for (const double frame : {12.0, 36.0}) {
    EXPECT_GT(expectHostMotion(shot.at(frame), scene, camera, frame), 0.1f) << frame;
  }
}

// A triangle that stands still while its scene's animation moves a node without a mesh.
scene::Scene stillTriangle() {
  AnimationBuilder still;
  still.addTriangle();
  still.add("nodes", {{"name", "empty"}});
  still.addChannel(1, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  return still.loadAnimated();
}

// The motion of the camera counts, for deformed meshes, moving instances, and what stands still.
TEST(MotionVectors, ContainTheMotionOfTheCamera) {
  const MovingCamera camera = [](double frame) {
    const auto t = static_cast<float>(frame);
    return perspective({0.5f + 0.05f * t, 1.0f, 4.0f - 0.02f * t}, {0.4f, 0.9f + 0.01f * t, 0}, 45);
  };
  AnimationBuilder moving = movingTriangle();
  moving.addChannel(1, "translation", {0, 1}, {0, 0, 0, 2, 1, 0});
  for (const scene::Scene& scene : {bendingStrip().loadAnimated(), moving.loadAnimated(), stillTriangle()}) {
    MotionShot shot(scene, camera);
    EXPECT_GT(expectHostMotion(shot.at(8), scene, camera, 8), 0.05f);
  }
}

// A point that was behind the camera has no position in the previous image. An orthographic camera has one for each point.
TEST(MotionVectors, AreZeroWhereAPointWasBehindThePreviousCamera) {
  const scene::Scene scene = stillTriangle();
  const scene::Camera facing = perspective({0.3f, 0.2f, 3}, {0.3f, 0.2f, 0}, 25);
  const scene::Camera away = perspective({0.3f, 0.2f, 3}, {0.3f, 0.2f, 9}, 25);
  const scene::Camera flat = orthographic({0.3f, 0.2f, 3}, {0.3f, 0.2f, 0}, 1);
  const scene::Camera flatBehind = orthographic({0, 0, -1}, {0, 0, -9}, 1);  // the triangle is behind it, too
  const std::array cameras{away, facing, away, flat, flatBehind, facing};
  const MovingCamera camera = [&](double frame) { return cameras.at(static_cast<std::size_t>(frame)); };
  MotionShot shot(scene, camera);
  for (const int frame : {1, 3}) {
    const MotionLayers layers = shot.at(frame);
    EXPECT_GT(std::ranges::count_if(layers.primitive, [](const vec4& id) { return id.x > 0.0f; }), 10) << frame;
    for (const vec4& motion : layers.motion) EXPECT_EQ(vec2(motion), vec2(0.0f)) << frame;
  }
  EXPECT_GT(expectHostMotion(shot.at(5), scene, camera, 5), 0.1f);
}

// The camera flies at the speed of the triangle, 10 m per frame, at a distance of 4 m. So the previous position of the triangle is
// behind the current camera, but not behind the previous one.
TEST(MotionVectors, FollowPointsFromBehindTheCurrentCamera) {
  AnimationBuilder flying = movingTriangle();
  flying.addChannel(1, "translation", {0, 1}, {0, 0, 0, 0, 0, -240});  // 24 frames
  const scene::Scene scene = flying.loadAnimated();
  const MovingCamera camera = [](double frame) {
    const auto t = static_cast<float>(frame);
    return perspective({0.4f + 0.1f * t, 0.4f, 4 - 10 * t}, {0.4f + 0.1f * t, 0.4f, -10 * t}, 25);
  };
  MotionShot shot(scene, camera);
  EXPECT_GT(expectHostMotion(shot.at(1), scene, camera, 1), 0.1f);
}

// A camera with keyframes in a scene file moves as cameras that are computed for each frame.
TEST(MotionVectors, ContainTheMotionOfKeyframes) {
  const scene::Scene scene = scene::parseSceneToml(R"([[mesh]]
shape = "quad"
size = 2
[[camera]]
look_from = [0, 1, 4]
look_at = [0, 0, 0]
fov = 45
keyframes = [{ frame = 0 }, { frame = 10, look_from = [1, 1, 4], look_at = [0.5, 0.2, 0], fov = 35 }]
)",
                                                   "camera.scene.toml");
  const MovingCamera expected = [](double frame) {
    const auto t = static_cast<float>(frame / 10);
    return perspective({t, 1, 4}, {0.5f * t, 0.2f * t, 0}, 45 - 10 * t);
  };
  MotionShot shot(scene, [&](double frame) {
    return scene::cameraAt(scene.cameras[0], scene::poseAt(scene.nodeAnimation.get(), frame));
  });
  EXPECT_GT(expectHostMotion(shot.at(6), scene, expected, 6), 0.1f);
}

// With a shutter, motion is that of the middle of its interval, like the position.
TEST(MotionVectors, ShowTheMiddleOfTheShutter) {
  const scene::Scene scene = bendingStrip().loadAnimated();
  const MovingCamera camera = [](double frame) {
    return perspective({0.5f + 0.05f * static_cast<float>(frame), 1.0f, 4.0f}, {0.5f, 1, 0}, 45);
  };
  MotionShot shot(scene, camera);
  const MotionLayers blurred = shot.at(10, render::ShutterInterval{9, 12});
  EXPECT_GT(expectHostMotion(blurred, scene, camera, 10.5), 0.3f);
}

// Without bounces, each sample has one ray. The ray that finds the motion is traced once for each pixel, not for each sample.
TEST(MotionVectors, NeedOneRayOfEachPixel) {
  MotionShot shot(stillTriangle(), standing(perspective({0.3f, 0.2f, 3}, {0.3f, 0.2f, 0}, 25)));
  shot.at(1);  // launches each sample alone, because the renderer does not know yet how long it takes
  shot.at(2);
  EXPECT_EQ(shot.raysOfTwoBatches(), kMotionSize * kMotionSize * (2 * render::kBatchSamples + 1));
}

}  // namespace
}  // namespace quintet::test
