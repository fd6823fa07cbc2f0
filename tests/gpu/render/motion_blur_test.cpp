// SPDX-License-Identifier: Apache-2.0
// Motion blur: a moving edge has its closed form, and each sample shows the scene that the host poses at the time of the
// sample (render/renderer/shutter.h), for instances, cameras, skins, morph targets and lights.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "harness.h"
#include "rendered_image.h"
#include "scene/animation/pose.h"
#include "scene/gltf_animation.h"
#include "scene/toml/scene_toml.h"

namespace quintet::test {
namespace {

using render::kBatchSamples;
using render::ShutterInterval;

constexpr std::uint32_t kBlurSize = 24;  // pixels in both directions

struct Shot {
  std::string program = "normals";
  scene::Camera camera = orthographic({0.5f, 1.0f, 5}, {0.5f, 1.0f, 0}, 3.0f);
  std::vector<std::string> set, outputs;
};

render::Renderer makeShot(render::DeviceScene& device, const Shot& shot,
                          const std::optional<ShutterInterval>& shutter = {}) {
  ImageOptions options;
  options.program = program::loadProgram(shot.program);
  options.set = shot.set;
  options.width = options.height = kBlurSize;
  render::RenderSettings settings = settingsFor(shot.camera, options);
  settings.outputs = shot.outputs;
  settings.shutter = shutter;
  return makeRenderer(device, options.program, settings);
}

// The scene at a frame, without its animation.
scene::Scene stillAt(scene::Scene scene, double frame) {
  scene::applyPose(scene, scene::poseAt(scene.nodeAnimation.get(), frame));
  scene.nodeAnimation = nullptr;
  for (scene::Mesh& mesh : scene.meshes) mesh.deformation = nullptr;
  for (scene::Light& light : scene.lights) {
    light.node = scene::kNone;
    light.values.clear();
  }
  scene.environment.values.clear();
  for (scene::Instance& instance : scene.instances) {
    instance.node = scene::kNone;
    instance.keyframes.clear();
  }
  return scene;
}

std::size_t indexOfOutput(const render::Renderer& renderer, const std::string& name) {
  const std::vector<std::string> names = program::outputNames(renderer.program());
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

double largestBlurDifference(const std::vector<vec4>& a, const std::vector<vec4>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t c = 0; c < 4; ++c) largest = std::max(largest, std::abs(double{a[i][c]} - double{b[i][c]}));
  return largest;
}

void addSamples(std::vector<vec4>& sums, const std::vector<vec4>& values) {
  sums.resize(values.size(), vec4(0.0f));
  for (std::size_t i = 0; i < values.size(); ++i) sums[i] += values[i];
}

// The first two batches of the scene with a shutter, against samples of still scenes.
void expectSamplesOfStillScenes(const scene::Scene& scene, const ShutterInterval& shutter, const Shot& shot = {}) {
  render::DeviceScene device(testContext(), scene::Scene(scene), scene.environment);
  render::Renderer blurred = makeShot(device, shot, shutter);
  std::vector<vec4> before;
  for (std::uint32_t batch = 0; batch < 2; ++batch) {
    blurred.renderBatch();
    const std::vector<vec4> sums = blurred.film().downloadBatch(0);
    std::vector<vec4> expected;
    for (std::uint32_t s = 0; s < kBatchSamples; ++s) {
      const std::uint32_t sample = batch * kBatchSamples + s;
      const double frame = render::sampleTime(shutter, sample, blurred.settings().seed);
      scene::Scene stillScene = stillAt(scene, frame);
      const scene::Environment environment = stillScene.environment;
      render::DeviceScene still(testContext(), std::move(stillScene), environment);
      render::Renderer renderer = makeShot(still, shot);
      renderer.renderSample(sample);
      const std::vector<vec4> values = renderer.film().downloadBatch(0);
      addSamples(expected, values);
      if (!before.empty()) {
        EXPECT_GT(largestBlurDifference(values, before), 0.05) << "nothing has moved in sample " << sample;
      }
      before = values;
    }
    EXPECT_LT(largestBlurDifference(sums, expected), 1e-3) << "batch " << batch;
  }
}

// A bar of 3 pixels that moves by 10 pixels. A pixel is covered during 0.3 of the shutter, less where the bar begins and
// ends: a trapezoid. The filter is symmetric, so it does not change the mean where the trapezoid is straight.
TEST(MotionBlur, ABarCoversPixelsAsLongAsItIsThere) {
  constexpr float kSpeed = 10, kWidth = 3, kBegin = -9.5f;  // pixels per frame, pixels, at frame 4
  SceneBuilder builder;
  builder.add(quad({kBegin - 4 * kSpeed, -20, 0}, {kWidth, 0, 0}, {0, 40, 0}), lambert(vec3(0.5f)));
  builder.scene.instances[0].keyframes = {{.frame = 0}, {.frame = 8, .translation = {8 * kSpeed, 0, 0}}};
  render::DeviceScene device(testContext(), scene::Scene(builder.scene), scene::Environment{});
  Shot shot;
  shot.camera = orthographic({0, 0, 5}, {0, 0, 0}, 0.5f * kBlurSize);
  constexpr std::uint32_t kSamples = 64;
  render::Renderer renderer = makeShot(device, shot, ShutterInterval{4, 5});
  for (std::uint32_t i = 0; i < kSamples / kBatchSamples; ++i) renderer.renderBatch();
  const io::Image image = renderer.film().download(0);
  int compared = 0;
  for (std::uint32_t x = 0; x < kBlurSize; ++x) {
    const float at = static_cast<float>(x) + 0.5f - 0.5f * kBlurSize - kBegin;  // from the left edge at the beginning
    float fromCorner = 10;
    for (const float corner : {0.0f, kWidth, kSpeed, kSpeed + kWidth})
      fromCorner = std::min(fromCorner, std::abs(at - corner));
    if (fromCorner < 0.75f) continue;
    ++compared;
    const float arrives = std::clamp((at - kWidth) / kSpeed, 0.0f, 1.0f), leaves = std::clamp(at / kSpeed, 0.0f, 1.0f);
    double mean = 0;
    for (std::uint32_t y = 0; y < kBlurSize; ++y) mean += double{image.pixel<float>(x, y)[2]} / kBlurSize;
    EXPECT_NEAR(mean, leaves - arrives, 1.0 / kSamples + 0.01) << "column " << x;
  }
  EXPECT_EQ(compared, 20);
}

TEST(MotionBlur, InstancesMoveWithKeyframes) {
  SceneBuilder builder;
  builder.add(quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), lambert(vec3(0.5f)));
  builder.scene.instances[0].keyframes = {{.frame = 0}, {.frame = 8, .translation = {2, 1, 0}}};
  expectSamplesOfStillScenes(builder.scene, {2, 6});
}

TEST(MotionBlur, SkinsBend) { expectSamplesOfStillScenes(bendingStrip(2).loadAnimated(), {6, 18}); }

TEST(MotionBlur, TargetsMorph) {
  Shot shot;
  shot.camera = perspective({3, 2, 4}, {0.5f, 1, 0}, 50);  // a displacement along z is visible
  expectSamplesOfStillScenes(morphingTriangle().loadAnimated(), {18, 40}, shot);
}

TEST(MotionBlur, LightsFollowTheirNodes) {
  AnimationBuilder builder;
  builder.addTriangle();
  builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 20.0}}};
  const int lamp = builder.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  builder.addChannel(lamp, "translation", {0, 1}, {0, 0, 1, 2, 1, 3});
  Shot shot{.program = "pathtracer",
            .camera = orthographic({0.5f, 0.5f, 5}, {0.5f, 0.5f, 0}, 1.0f),
            .set = {"bounces=1"},
            .outputs = {}};
  expectSamplesOfStillScenes(builder.loadAnimated(), {0, 24}, shot);
}

// A spot light that follows its target, and an environment that fades in.
TEST(MotionBlur, KeyframesMoveLightsOfSceneFiles) {
  const scene::Scene scene = scene::parseSceneToml(R"([[mesh]]
shape = "plane"
size = 4
[[light]]
type = "spot"
position = [0, 2, 0]
target = [-1, 0, 0]
intensity = 40
outer_angle = 25
interpolation = "cubic"
keyframes = [{ frame = 0 }, { frame = 4, target = [1, 0, 1], color = [1, 0.2, 0] }]
[environment]
color = [1, 1, 1]
keyframes = [{ frame = 0, intensity = 0 }, { frame = 4, intensity = 2 }]
)",
                                                   "lights.scene.toml");
  const Shot shot{
      .program = "pathtracer", .camera = perspective({0, 5, 0.1f}, {0, 0, 0}, 40), .set = {"bounces=1"}, .outputs = {}};
  expectSamplesOfStillScenes(scene, {0, 4}, shot);
}

// The camera turns by 90° per frame. Each batch is the sum of the samples of four cameras, bit for bit.
TEST(MotionBlur, CamerasTurn) {
  SceneBuilder builder;
  builder.add(quad({-1, -1, -3}, {2, 0, 0}, {0, 2, 0}), lambert(vec3(0.5f)));
  builder.add(quad({3, -1, -1}, {0, 0, 2}, {0, 2, 0}), lambert(vec3(0.5f)));
  builder.scene.instances[0].keyframes = {{.frame = 0}};  // an animation, in which only the camera moves
  render::DeviceScene device(testContext(), scene::Scene(builder.scene), scene::Environment{});
  const auto cameraAt = [](double frame) {
    const auto angle = static_cast<float>(0.5 * kPi * frame);
    return perspective({0, 0, 0}, {std::sin(angle), 0, -std::cos(angle)}, 60);
  };
  render::Renderer still = makeShot(device, {});
  render::Renderer blurred = makeShot(device, {});
  blurred.setShutter(ShutterInterval{0.25, 0.75}, cameraAt);
  blurred.renderBatch();
  std::vector<vec4> expected;
  for (std::uint32_t sample = 0; sample < kBatchSamples; ++sample) {
    still.setCamera(cameraAt(render::sampleTime({0.25, 0.75}, sample, still.settings().seed)));
    still.renderSample(sample);
    addSamples(expected, still.film().downloadBatch(0));
  }
  EXPECT_EQ(blurred.film().downloadBatch(0), expected);
  blurred.setShutter({}, {});
  still.setCamera(blurred.settings().camera);
  blurred.renderBatch();
  still.renderBatch();
  EXPECT_EQ(blurred.film().downloadBatch(0), still.film().downloadBatch(0)) << "without a shutter again";
}

// Outputs of pixel centers have one value per pixel: that of the middle of the shutter.
TEST(MotionBlur, PixelCentersShowTheMiddle) {
  const scene::Scene scene = bendingStrip().loadAnimated();
  // The outputs of motion_vectors_test.cpp, so that the tests share a compiled program.
  const Shot shot{.program = "pathtracer", .set = {"bounces=0"}, .outputs = {"motion", "position", "primitive_id"}};
  render::DeviceScene device(testContext(), scene::Scene(scene), scene::Environment{});
  render::DeviceScene middle(testContext(), stillAt(scene, 11), scene::Environment{});
  render::Renderer blurred = makeShot(device, shot, ShutterInterval{8, 14}), still = makeShot(middle, shot);
  blurred.renderBatch();
  blurred.renderBatch();  // does not change the values of pixel centers
  still.renderBatch();
  for (const char* name : {"position", "primitive_id"}) {
    const std::size_t index = indexOfOutput(still, name);
    const std::vector<vec4> values = still.film().plane(index).values;
    EXPECT_LT(largestBlurDifference(blurred.film().plane(index).values, values), 1e-4) << name;
    EXPECT_GT(largestBlurDifference(values, std::vector<vec4>(values.size(), values[0])), 0.5) << name;
  }
}

}  // namespace
}  // namespace quintet::test
