// SPDX-License-Identifier: Apache-2.0
// glTF animations on the device: each frame is that of the scene which the host poses (scene/animation/pose.h),
// whichever frames were shown before.
#include <gtest/gtest.h>

#include "harness.h"
#include "rendered_image.h"
#include "scene/animation/pose.h"
#include "scene/gltf_animation.h"
#include "scene/toml/scene_toml.h"

namespace quintet::test {
namespace {

// The scene at a frame, without its animation.
scene::Scene posedByHost(scene::Scene scene, double frame) {
  scene::applyPose(scene, scene::poseAt(scene.nodeAnimation.get(), frame));
  scene.nodeAnimation = nullptr;
  scene.materialStates.clear();
  std::erase_if(scene.instances, [](const scene::Instance& instance) {  // hidden
    return glm::determinant(mat3(instance.worldFromObject)) == 0.0f;
  });
  for (scene::Mesh& mesh : scene.meshes) mesh.deformation = nullptr;
  for (scene::Instance& instance : scene.instances) instance.node = instance.visibleNode = scene::kNone;
  for (scene::Light& light : scene.lights) {
    light.node = light.visibleNode = scene::kNone;
    light.values.clear();
  }
  scene.environment.values.clear();
  return scene;
}

struct View {
  std::string program = "normals";
  scene::Camera camera = orthographic({0.5f, 1.0f, 5}, {0.5f, 1.0f, 0}, 3.0f);
  std::vector<std::string> set;
  std::uint32_t batches = 1;
};

std::vector<vec4> renderView(render::DeviceScene& device, const View& view) {
  ImageOptions options;
  options.program = program::loadProgram(view.program);
  options.set = view.set;
  options.width = options.height = 24;
  render::Renderer renderer = makeRenderer(device, options.program, settingsFor(view.camera, options));
  for (std::uint32_t i = 0; i < view.batches; ++i) renderer.renderBatch(render::kBatchSamples);
  return renderer.film().downloadBatch(0);
}

std::vector<vec4> renderPosed(const scene::Scene& scene, double frame, const View& view) {
  scene::Scene posed = posedByHost(scene, frame);
  const scene::Environment environment = posed.environment;
  render::DeviceScene device(testContext(), std::move(posed), environment);
  return renderView(device, view);
}

double largestDifference(const std::vector<vec4>& a, const std::vector<vec4>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t c = 0; c < 4; ++c) largest = std::max(largest, std::abs(double{a[i][c]} - double{b[i][c]}));
  return largest;
}

bool hasImage(const std::vector<vec4>& pixels) {
  return std::ranges::any_of(pixels, [&](const vec4& p) { return p != pixels[0]; });
}

// Shows the frames one after the other on one device scene, and compares each with the host's pose.
void expectHostPoses(const scene::Scene& scene, const std::vector<double>& frames, const View& view = {}) {
  render::DeviceScene device(testContext(), scene::Scene(scene), scene.environment);
  EXPECT_TRUE(device.animated());
  std::vector<vec4> before;
  for (const double frame : frames) {
    device.setFrame(frame);
    const std::vector<vec4> shown = renderView(device, view);
    EXPECT_TRUE(hasImage(shown)) << frame;
    EXPECT_LT(largestDifference(shown, renderPosed(scene, frame, view)), 1e-4) << frame;
    if (!before.empty()) {
      EXPECT_GT(largestDifference(shown, before), 0.1) << "nothing has moved at " << frame;
    }
    before = shown;
  }
}

TEST(Animation, NodesMoveInstances) {
  AnimationBuilder builder = movingTriangle();
  const float half = std::sqrt(0.5f);
  builder.addChannel(1, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, half, half});
  builder.addChannel(1, "scale", {0, 1}, {1, 1, 1, 2, 2, 2});
  expectHostPoses(builder.loadAnimated(), {12, 24, 3});
}

TEST(Animation, SkinsBend) { expectHostPoses(bendingStrip(2).loadAnimated(), {12, 24, 6}); }

TEST(Animation, TargetsMorph) {
  View view;
  view.camera = perspective({3, 2, 4}, {0.5f, 1, 0}, 50);  // a displacement along z is visible
  expectHostPoses(morphingTriangle().loadAnimated(), {24, 48, 12}, view);
}

// A BLAS is refitted while its tree is good, and built again when it is not.
TEST(Animation, BuildsAgainWhenTheTreeHasDecayed) {
  // Small triangles in a row. One target exchanges their order, the other moves all of them alike.
  constexpr std::size_t kTriangles = 64;
  std::vector<float> positions, exchanged, moved;
  for (std::size_t i = 0; i < kTriangles; ++i) {
    const std::size_t other = i * 37 % kTriangles;
    const float x = 0.1f * static_cast<float>(i), shift = 0.1f * static_cast<float>(other) - x;
    positions.insert(positions.end(), {x, 0, 0, x + 0.08f, 0, 0, x, 2, 0});
    for (int corner = 0; corner < 3; ++corner) {
      exchanged.insert(exchanged.end(), {shift, 0, 0});
      moved.insert(moved.end(), {0, 0.5f, 0});
    }
  }
  AnimationBuilder builder;
  builder.addMesh(
      {{"attributes", {{"POSITION", builder.addAccessor(positions, "VEC3")}}},
       {"targets",
        {{{"POSITION", builder.addAccessor(exchanged, "VEC3")}}, {{"POSITION", builder.addAccessor(moved, "VEC3")}}}}});
  builder.addChannel(0, "weights", {0, 1, 2}, {0, 0, 0, 1, 1, 0});
  const scene::Scene scene = builder.loadAnimated();
  View view;
  view.camera = orthographic({3, 1, 5}, {3, 1, 0}, 4.0f);
  render::DeviceScene device(testContext(), scene::Scene(scene), scene::Environment{});
  device.setFrame(24);
  EXPECT_EQ(device.deformationStatistics().refits, 1u);
  EXPECT_EQ(device.deformationStatistics().builds, 0u);
  device.setFrame(48);
  EXPECT_EQ(device.deformationStatistics().refits, 1u);
  EXPECT_EQ(device.deformationStatistics().builds, 1u);
  EXPECT_LT(largestDifference(renderView(device, view), renderPosed(scene, 48, view)), 1e-4);
  device.setFrame(48);  // nothing to do
  EXPECT_EQ(device.deformationStatistics().builds, 1u);
}

// Light from a deformed emitter on a floor: the light tables follow the vertices.
TEST(Animation, DeformedEmittersLight) {
  AnimationBuilder builder = bendingStrip();
  builder.add("materials", {{"emissiveFactor", {1, 1, 1}},
                            {"doubleSided", true},
                            {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}}}});
  builder.primitive()["material"] = 0;
  const int floor =
      builder.addAccessor<float>({-4, -1, 4, 4, -1, 4, 4, -1, -4, -4, -1, 4, 4, -1, -4, -4, -1, -4}, "VEC3");
  builder.addMesh({{"attributes", {{"POSITION", floor}}}});
  View view{
      .program = "pathtracer", .camera = perspective({0, 6, 6}, {0, -1, 0}, 50), .set = {"bounces=1"}, .batches = 2};
  const scene::Scene scene = builder.loadAnimated();
  render::DeviceScene device(testContext(), scene::Scene(scene), scene::Environment{});
  for (const double frame : {12.0, 24.0}) {
    device.setFrame(frame);
    EXPECT_LT(largestDifference(renderView(device, view), renderPosed(scene, frame, view)), 1e-3) << frame;
  }
}

TEST(Animation, PunctualLightsFollowTheirNodes) {
  AnimationBuilder builder = movingTriangle();
  builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 20.0}}};
  const int lamp = builder.add("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  builder.addChannel(lamp, "translation", {0, 1}, {0, 0, 1, 2, 1, 3});
  View view{.program = "pathtracer",
            .camera = orthographic({1.5f, 0.5f, 5}, {1.5f, 0.5f, 0}, 1.0f),
            .set = {"bounces=1"},
            .batches = 1};
  expectHostPoses(builder.loadAnimated(), {6, 24}, view);
}

// KHR_animation_pointer: a material that emits only later, and lights a floor.
TEST(Animation, PointersChangeMaterials) {
  AnimationBuilder builder;
  builder.addTriangle();
  const int floor =
      builder.addAccessor<float>({-4, -1, 4, 4, -1, 4, 4, -1, -4, -4, -1, 4, 4, -1, -4, -4, -1, -4}, "VEC3");
  builder.addMesh({{"attributes", {{"POSITION", floor}}}, {"material", 1}});
  builder.add("materials", {{"doubleSided", true}});
  builder.add("materials", {{"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
  builder.primitive()["material"] = 0;
  builder.addPointer("/materials/0/emissiveFactor", {0, 1}, {0, 0, 0, 8, 4, 2}, "VEC3");
  builder.addPointer("/materials/0/pbrMetallicRoughness/baseColorFactor", {0, 1}, {0, 0, 0, 1, 0, 0, 0, 1}, "VEC4");
  builder.addPointer("/materials/1/pbrMetallicRoughness/baseColorFactor", {0, 1}, {0, 0, 0, 1, 1, 1, 1, 1}, "VEC4");
  View view{
      .program = "pathtracer", .camera = perspective({0, 6, 6}, {0, -1, 0}, 50), .set = {"bounces=1"}, .batches = 2};
  const scene::Scene scene = builder.loadAnimated();
  render::DeviceScene device(testContext(), scene::Scene(scene), scene::Environment{});
  for (const double frame : {12.0, 24.0, 6.0}) {
    device.setFrame(frame);
    const std::vector<vec4> shown = renderView(device, view);
    EXPECT_TRUE(hasImage(shown));
    EXPECT_LT(largestDifference(shown, renderPosed(scene, frame, view)), 1e-3) << frame;
  }
}

// A lamp that is dark at frame 0 and a spot light that follows its target, over a floor.
TEST(Animation, KeyframesMoveLightsOfSceneFiles) {
  const scene::Scene scene = scene::parseSceneToml(R"([[mesh]]
shape = "plane"
size = 4
[[light]]
type = "point"
position = [-1, 1, 0]
intensity = 0
keyframes = [{ time = 0 }, { time = 1, intensity = 8, color = [1, 0.5, 0] }]
[[light]]
type = "spot"
position = [0, 2, 0]
target = [-1, 0, 0]
intensity = 9
outer_angle = 20
keyframes = [{ time = 0 }, { time = 1, target = [1, 0, 1], position = [0.5, 2, 0.5], inner_angle = 15 }]
)",
                                                   "lights.scene.toml");
  const View view{.program = "pathtracer", .camera = perspective({0, 5, 0.1f}, {0, 0, 0}, 40), .set = {"bounces=1"}};
  expectHostPoses(scene, {12, 24, 0}, view);
}

// An area light that is off at frame 0, over a floor that changes its color.
TEST(Animation, KeyframesChangeMaterialsOfSceneFiles) {
  const scene::Scene scene = scene::parseSceneToml(R"([[material]]
name = "floor"
base_color = [1, 0, 0]
keyframes = [{ time = 0 }, { time = 1, base_color = [0, 1, 0] }]
[[material]]
name = "lamp"
base_color = [0, 0, 0]
emissive = [1, 1, 1]
keyframes = [{ time = 0, emissive_strength = 0 }, { time = 1, emissive_strength = 8 }]
[[mesh]]
shape = "plane"
size = 4
material = "floor"
[[mesh]]
shape = "plane"
size = 1
material = "lamp"
translate = [0, 1, -1]
rotate = [180, 0, 0]
)",
                                                   "lamp.scene.toml");
  const View view{
      .program = "pathtracer", .camera = perspective({0, 3, 5}, {0, 0, 0}, 40), .set = {"bounces=1"}, .batches = 2};
  render::DeviceScene device(testContext(), scene::Scene(scene), scene::Environment{});
  std::vector<vec4> before;
  for (const double frame : {12.0, 24.0, 3.0}) {
    device.setFrame(frame);
    const std::vector<vec4> shown = renderView(device, view);
    EXPECT_LT(largestDifference(shown, renderPosed(scene, frame, view)), 1e-3) << frame;
    if (!before.empty()) {
      EXPECT_GT(largestDifference(shown, before), 0.1) << frame;
    }
    before = shown;
  }
}

// An environment that is black at frame 0 and turns, over a floor and in the background.
TEST(Animation, KeyframesMoveTheEnvironment) {
  scene::Scene scene = scene::parseSceneToml(R"([[mesh]]
shape = "plane"
size = 4
[environment]
color = [1, 1, 1]
keyframes = [{ time = 0, intensity = 0 }, { time = 0.5, intensity = 2, rotation = 40 }, { time = 1, rotation = 150 }]
)",
                                             "sky.scene.toml");
  const View view{.program = "pathtracer", .camera = perspective({0, 2, 4}, {0, 0, 0}, 60), .set = {"bounces=1"}};
  expectHostPoses(scene, {6, 12}, view);
  // An image, which is lit on one side.
  scene.environment.image = io::makeImage(8, 4, 3, io::PixelType::f32, io::ColorEncoding::linear);
  for (std::uint32_t y = 0; y < 4; ++y)
    for (std::uint32_t x = 0; x < 3; ++x) std::ranges::fill(scene.environment.image.pixel<float>(x, y), 4.0f);
  expectHostPoses(scene, {6, 12, 24}, view);
}

// Nothing else has alpha, and the material is opaque at the start.
TEST(Animation, PointersHideMaskedMaterials) {
  AnimationBuilder builder = movingTriangle();
  builder.add("materials", {{"alphaMode", "MASK"}});
  builder.add("materials", Json::object());
  builder.primitive()["material"] = 0;
  builder.add("meshes", builder.root["meshes"][0]);
  builder.primitive(1)["material"] = 1;
  builder.add("nodes", {{"mesh", 1}, {"translation", {0, 1, 0}}});
  builder.addPointer("/materials/0/alphaCutoff", {0, 1}, {0.5f, 1.5f}, "SCALAR");
  expectHostPoses(builder.loadAnimated(), {6, 18, 3});
}

TEST(Animation, PointersChangeLightsAndVisibility) {
  AnimationBuilder builder = movingTriangle();
  builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 20.0}}};
  builder.add("nodes", {{"translation", {1.5f, 0.5f, 2}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  builder.addPointer("/extensions/KHR_lights_punctual/lights/0/color", {0, 1}, {0, 0, 1, 1, 1, 0}, "VEC3");
  View view{.program = "pathtracer",
            .camera = orthographic({1.5f, 0.5f, 5}, {1.5f, 0.5f, 0}, 1.0f),
            .set = {"bounces=1"},
            .batches = 1};
  expectHostPoses(builder.loadAnimated(), {6, 24}, view);
  // Two more triangles, of which one is shown in each half.
  const std::size_t first = builder.root["nodes"].size();
  for (int i = 0; i < 2; ++i)
    builder.add("nodes", {{"mesh", 0}, {"translation", {0, 0.5f + static_cast<float>(i), 0}}});
  for (std::size_t i = 0; i < 2; ++i)
    builder.addPointer("/nodes/" + std::to_string(first + i) + "/extensions/KHR_node_visibility/visible", {0, 0.5f},
                       {i == 0 ? 1.0f : 0.0f, i == 0 ? 0.0f : 1.0f}, "SCALAR", "STEP");
  expectHostPoses(builder.loadAnimated(), {6, 18, 3});
}

}  // namespace
}  // namespace quintet::test
