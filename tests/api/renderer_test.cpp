// SPDX-License-Identifier: Apache-2.0
// Renderers: limits, progress, cancellation, checkpoints, and edits, which give the image of a scene that was built with them.
#include <unistd.h>

#include <filesystem>
#include <limits>
#include <string>

#include <gmock/gmock.h>

#include "scenes.h"

namespace quintet::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ApiRenderer : public testing::Test {
 protected:
  Scene scene_ = lampScene();
  Renderer renderer_{device(), scene_, pathTracer(), smallImage()};

  std::vector<float> image(std::uint32_t samples = 4) {
    renderer_.render(samples);
    return renderer_.image().pixels;
  }
};

TEST_F(ApiRenderer, ContinuesToTheSameBytes) {
  EXPECT_EQ(renderer_.render(4).samples, 4);
  const RenderReport report = renderer_.render({.samples = 12});
  EXPECT_EQ(report.samples, 12);
  EXPECT_EQ(report.reason, StopReason::samples);
  EXPECT_GT(report.rays, 48u * 32u * 12u);
  EXPECT_EQ(report.droppedSamples, 0u);
  EXPECT_EQ(renderer_.sampleCount(), 12u);
  EXPECT_EQ(renderer_.image().pixels, rendered(scene_, smallImage(), 12));
}

TEST(ApiSeveralDevices, RenderTheSameBytes) {
  Device two({.choice = "0,0"});
  ASSERT_EQ(two.infos().size(), 2u);
  EXPECT_EQ(two.infos()[1].name, two.name());
  Scene scene = lampScene();
  Renderer renderer(two, scene, pathTracer(), smallImage());
  renderer.render(20);
  EXPECT_EQ(renderer.image().pixels, rendered(scene, smallImage(), 20));
  renderer.setTransform(2, Transform::translation({-0.6f, 1, 0}));
  renderer.render(8);
  Renderer moved(device(), scene, pathTracer(), smallImage());
  moved.setTransform(2, Transform::translation({-0.6f, 1, 0}));
  moved.render(8);
  EXPECT_EQ(renderer.image().pixels, moved.image().pixels);
  EXPECT_THROW(Device({.choice = "0,"}), UsageError);
  EXPECT_THROW(Device({.choice = "0,99"}), Error);
}

TEST_F(ApiRenderer, StopsWhenProgressReturnsFalse) {
  int calls = 0;
  double last = 0;
  const RenderReport report = renderer_.render({.samples = 4000}, [&](const Progress& progress) {
    EXPECT_GE(progress.samples, last);
    EXPECT_LE(progress.fraction, 1);
    last = progress.samples;
    return ++calls < 3;
  });
  EXPECT_EQ(report.reason, StopReason::canceled);
  EXPECT_LT(report.samples, 4000);
  EXPECT_GE(report.samples, 4);
  EXPECT_EQ(report.samples, static_cast<double>(renderer_.sampleCount()));
  EXPECT_EQ(renderer_.image().pixels, rendered(scene_, smallImage(), static_cast<std::uint32_t>(report.samples)));
}

TEST_F(ApiRenderer, StopsAtAnErrorAndAtATime) {
  const RenderReport error = renderer_.render({.samples = 4096, .error = 0.5});
  EXPECT_EQ(error.reason, StopReason::error);
  ASSERT_TRUE(error.error);
  EXPECT_LE(*error.error, 0.5);
  renderer_.restart();
  EXPECT_EQ(renderer_.sampleCount(), 0u);
  const RenderReport time = renderer_.render({.seconds = 0.01});
  EXPECT_EQ(time.reason, StopReason::time);
  EXPECT_GE(time.samples, 4);
  EXPECT_THROW(renderer_.render(Limits{}), UsageError);
  EXPECT_THROW(renderer_.render({.error = -1.0}), UsageError);
}

TEST_F(ApiRenderer, ReportsWhyAdaptiveSamplingStops) {
  Settings settings = smallImage();
  settings.adaptive = true;
  Renderer renderer(device(), scene_, pathTracer(), settings);
  const RenderReport report = renderer.render({.samples = 41});
  EXPECT_EQ(report.reason, StopReason::samples);
  EXPECT_GT(report.samples, 32) << "16 samples are uniform, all others adaptive";
  EXPECT_EQ(report.samples, renderer.film().sampleCount());
  EXPECT_EQ(renderer.sampleCount(), renderer.film().sampleCount());
  EXPECT_GT(renderer.render(16).samples, report.samples + 8);
}

// The squares exceed the range of the film, so the error of the image is never known.
TEST_F(ApiRenderer, StopsIfTheErrorCannotBeKnown) {
  Renderer renderer(device(), scene_, constantProgram("vec4(1e12)"), smallImage());
  EXPECT_EQ(renderer.render({.error = 0.1}).reason, StopReason::unknownError);
  int calls = 0;
  const RenderReport report = renderer.render({.samples = 32, .error = 0.1}, [&](const Progress& progress) {
    EXPECT_FALSE(progress.error);
    return ++calls > 0;
  });
  EXPECT_GT(calls, 0);
  EXPECT_EQ(report.reason, StopReason::samples);
  EXPECT_FALSE(report.error);
}

TEST_F(ApiRenderer, CountsTheSamplesOfAPart) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "api_part.qfilm";
  Settings settings = smallImage();
  settings.plannedSamples = 30;
  settings.batches = Batches{4, 7};
  Renderer part(device(), scene_, pathTracer(), settings);
  EXPECT_EQ(part.render(4).samples, 4);
  EXPECT_EQ(part.sampleCount(), 4);
  part.saveCheckpoint(file);
  EXPECT_EQ(part.render({.samples = 8}).samples, 8);
  const RenderReport report = part.render({.samples = 100}, [](const Progress& progress) {
    EXPECT_LE(progress.samples, 14);
    EXPECT_GT(progress.fraction, 0.5);
    return true;
  });
  EXPECT_EQ(report.samples, 14) << "the end of the whole render";
  EXPECT_EQ(report.reason, StopReason::samples);

  Renderer second(device(), scene_, pathTracer(), settings);
  EXPECT_TRUE(second.resume(file));
  EXPECT_EQ(second.sampleCount(), 4);
  EXPECT_EQ(second.render(Limits{}).samples, 14);
  EXPECT_EQ(second.image().pixels, part.image().pixels);
  std::filesystem::remove(file);
}

TEST_F(ApiRenderer, APartCanStopAtATime) {
  Settings settings = smallImage();
  settings.plannedSamples = 4'000'000;
  settings.batches = Batches{500'000, 999'999};
  Renderer part(device(), scene_, pathTracer(), settings);
  const RenderReport report = part.render({.seconds = 0.01});
  EXPECT_EQ(report.reason, StopReason::time);
  EXPECT_GE(report.samples, 4);
}

TEST_F(ApiRenderer, WarnsOfAMissedTarget) {
  const RenderReport report = renderer_.render({.samples = 8, .error = 1e-6});
  EXPECT_EQ(report.reason, StopReason::samples);
  EXPECT_THAT(report.warnings, ElementsAre(HasSubstr("target error")));
}

// Every edit gives exactly the image of a new renderer of the edited scene.

TEST_F(ApiRenderer, MovesInstances) {
  const std::vector<float> before = image();
  const Transform moved = Transform::translation({-0.5f, 1.5f, 0.3f}) * Transform::rotation({0, 0, 1}, 0.4f);
  renderer_.setTransform(2, moved);
  scene_.setTransform(2, moved);
  EXPECT_EQ(renderer_.sampleCount(), 0u);
  EXPECT_EQ(image(), rendered(scene_));
  EXPECT_NE(image(), before);
}

TEST_F(ApiRenderer, MovesLamps) {
  image();
  const Transform moved = Transform::translation({1, 3, 0}) * Transform::scaling({1, 1, 0.2f});
  renderer_.setTransform(1, moved);
  scene_.setTransform(1, moved);
  EXPECT_EQ(image(), rendered(scene_));
}

// A cutoff above 1 hides a surface, and a lower one shows it again.
TEST_F(ApiRenderer, HidesSurfacesByTheCutoff) {
  const std::vector<float> before = image();
  for (const int index : {0, 2}) {
    Material material = scene_.material(index);
    material.alphaMode = AlphaMode::mask;
    for (const float cutoff : {1.5f, 1.0f, 2.0f}) {
      material.alphaCutoff = cutoff;
      renderer_.setMaterial(index, material);
      scene_.setMaterial(index, material);
      const std::vector<float> edited = image();
      EXPECT_EQ(edited, rendered(scene_)) << index << ' ' << cutoff;
      EXPECT_EQ(edited != before, index == 2 || cutoff > 1.0f) << index << ' ' << cutoff;
    }
  }
}

TEST_F(ApiRenderer, MovesInstancesSeveralTimes) {
  for (const float x : {0.1f, 0.2f, 0.3f}) {
    for (const int instance : {1, 2}) {
      renderer_.setTransform(instance, Transform::translation({x, 2, 0}));
      scene_.setTransform(instance, Transform::translation({x, 2, 0}));
    }
    EXPECT_EQ(image(), rendered(scene_)) << x;
  }
}

TEST_F(ApiRenderer, ChangesMaterialsInPlace) {
  image();
  Material material = scene_.material(0);
  material.baseColor = {0.1f, 0.3f, 0.9f, 1};
  material.roughness = 0.2f;
  material.metallic = 1;
  renderer_.setMaterial(0, material);
  scene_.setMaterial(0, material);
  EXPECT_EQ(image(), rendered(scene_));
}

TEST_F(ApiRenderer, ChangesMaterialsBeyondTheirTable) {
  image();
  Material coated = scene_.material(0);  // a feature that no material had
  coated.clearcoat = 1;
  Material bright = scene_.material(1);  // emission
  bright.emissive = {20, 2, 2};
  Material cut = scene_.material(2);  // an alpha test
  cut.alphaMode = AlphaMode::blend;
  cut.baseColor[3] = 0.5f;
  int index = 0;
  for (const Material& material : {coated, bright, cut}) {
    renderer_.setMaterial(index, material);
    scene_.setMaterial(index++, material);
    EXPECT_EQ(image(), rendered(scene_)) << material.name;
  }
  renderer_.setTransform(2, Transform::translation({0, 1, 1}));  // the rebuilt scene can be edited, too
  scene_.setTransform(2, Transform::translation({0, 1, 1}));
  EXPECT_EQ(image(), rendered(scene_));
}

// A square without normals and tangents, beside one whose normal map is on the device from the start.
TEST_F(ApiRenderer, NormalMapsOfEditedMaterialsHaveTangents) {
  const std::array<float, 12> texels{0.8f, 0.5f, 0.9f, 0.5f, 0.9f, 0.8f, 0.2f, 0.4f, 0.8f, 0.5f, 0.5f, 1};
  const std::array<Float2, 4> uv{{{0, 1}, {1, 1}, {1, 0}, {0, 0}}};
  const Material plain{.name = "edited"}, mapped{.name = "edited", .normalTexture = {.texture = 0}};
  const auto sceneWith = [&](const Material& material) {
    Scene scene;
    scene.addTexture({.width = 2, .height = 2, .channels = 3, .pixels = std::span<const float>(texels)});
    for (const Material& m : {material, mapped}) {
      const int mesh =
          scene.addMesh({.positions = kCorners, .indices = kSquare, .uv0 = uv, .material = scene.addMaterial(m)});
      scene.addInstance({.mesh = mesh, .worldFromObject = Transform::translation({mesh == 0 ? -1.0f : 1.0f, 0, 0})});
    }
    scene.addLight({.intensity = {20, 20, 20}, .position = {1, 2, 1}});
    return scene;
  };
  const std::vector<float> expected = rendered(sceneWith(mapped));
  EXPECT_NE(rendered(sceneWith(plain)), expected);
  Scene edited = sceneWith(plain);
  edited.setMaterial(0, mapped);
  EXPECT_EQ(rendered(edited), expected);
  Renderer renderer(device(), sceneWith(plain), pathTracer(), smallImage());
  renderer.render(4);
  renderer.setMaterial(0, mapped);
  renderer.render(4);
  EXPECT_EQ(renderer.image().pixels, expected);
}

// A program that does not compile for scenes with clear coat.
TEST_F(ApiRenderer, RecoversFromAFailedRebuild) {
  const Program program =
      constantProgram("vec4(0.5)", "#ifndef QUINTET_NO_CLEARCOAT\n#error clear coat is not supported\n#endif");
  Renderer renderer(device(), scene_, program, smallImage());
  renderer.render(4);
  Material coated = scene_.material(0);
  coated.clearcoat = 1;
  renderer.setMaterial(0, coated);
  for (int i = 0; i < 2; ++i) {
    EXPECT_THROW(renderer.render(4), ProgramError);
    EXPECT_EQ(renderer.sampleCount(), 0);
    EXPECT_THROW(renderer.image(), Error);
    EXPECT_THROW(renderer.film(), Error);
  }
  renderer.setTransform(2, Transform::translation({0, 1, 1}));
  renderer.setFrame(0);
  renderer.setCamera(kCamera);
  renderer.setMaterial(0, scene_.material(0));
  EXPECT_EQ(renderer.render(4).samples, 4);
  EXPECT_EQ(renderer.image().at(0, 0)[0], 0.5f);
}

TEST_F(ApiRenderer, ReportsWarningsOfARebuild) {
  const std::array<float, 3> texel{1, 1, 1};
  Scene empty;
  empty.addMaterial({});
  empty.addTexture({.width = 1, .height = 1, .channels = 3, .pixels = std::span<const float>(texel)});
  Renderer renderer(device(), empty, pathTracer(), smallImage());
  const auto isReported = testing::Contains(HasSubstr("no surfaces"));
  EXPECT_THAT(renderer.render(4).warnings, isReported);
  renderer.setMaterial(0, {.emissiveTexture = {.texture = 0}});  // a texture that is not on the device
  renderer.setFrame(0);
  EXPECT_THAT(renderer.render(4).warnings, isReported);
  renderer.setMaterial(0, {.normalTexture = {.texture = 0}});  // not with this encoding
  EXPECT_FALSE(renderer.resume("missing.qfilm"));
  EXPECT_THAT(renderer.render(4).warnings, isReported);
  EXPECT_THAT(renderer.render(4).warnings, testing::Not(isReported));
}

TEST_F(ApiRenderer, ChangesImageParameters) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / ("api_parameter_" + std::to_string(::getpid()) + ".exr");
  Image{1, 1, {0.25f, 0.5f, 1, 1}}.write(file);
  std::string parameters;  // more than half of the slots for images
  for (int i = 0; i < 40; ++i)
    parameters += "[[parameter]]\nname = \"map" + std::to_string(i) + "\"\ntype = \"image\"\ndefault = \"\"\n";
  const Program program = constantProgram("sampleParameter(parameters.map39, vec2(0.5))", "", parameters);
  Renderer renderer(device(), scene_, program, smallImage());
  renderer.render(4);
  EXPECT_THROW(renderer.setParameter("map39", "missing.png"), FileError);
  EXPECT_EQ(renderer.sampleCount(), 4);
  EXPECT_EQ(renderer.image().at(3, 3)[0], 1);
  renderer.render(4);
  EXPECT_EQ(renderer.image().at(3, 3)[0], 1);
  renderer.setParameter("map39", file.string());
  EXPECT_EQ(renderer.sampleCount(), 0);
  renderer.render(4);
  EXPECT_EQ(renderer.image().at(3, 3)[0], 0.25f);
  std::filesystem::remove(file);
}

TEST_F(ApiRenderer, ChangesCameraAndParameters) {
  image();
  const Camera camera{.lookFrom = {3, 3, 3}, .verticalFov = 0.9f, .apertureRadius = 0.1f};
  renderer_.setCamera(camera);
  renderer_.setParameter("bounces", "1");
  renderer_.setParameter("bounces", "2");
  Settings settings = smallImage();
  settings.camera = camera;
  settings.parameters = {{"bounces", "2"}};
  EXPECT_EQ(image(), rendered(scene_, settings));
}

TEST_F(ApiRenderer, RejectedEditsChangeNothing) {
  EXPECT_THROW(renderer_.setTransform(3, {}), UsageError);
  EXPECT_THROW(renderer_.setTransform(-1, {}), UsageError);
  EXPECT_THROW(renderer_.setTransform(0, Transform::scaling({0, 1, 1})), UsageError);
  EXPECT_THROW(renderer_.setMaterial(9, {}), UsageError);
  EXPECT_THROW(renderer_.setMaterial(0, {.roughness = -1}), UsageError);
  EXPECT_THROW(renderer_.setParameter("bouncs", "2"), UsageError);
  EXPECT_THROW(renderer_.setParameter("bounces", "many"), UsageError);
  EXPECT_THROW(renderer_.setCamera({.verticalFov = -1}), UsageError);
  EXPECT_THROW(renderer_.setFrame(std::numeric_limits<float>::quiet_NaN()), UsageError);
  EXPECT_EQ(image(), rendered(scene_));
}

TEST_F(ApiRenderer, SetsFramesOfKeyframes) {
  Scene animated = lampScene();
  const int added = animated.addInstance(
      {.mesh = 1, .keyframes = {{.frame = 0, .translation = {-1, 1, 0}}, {.frame = 10, .translation = {1, 2, 0}}}});
  Renderer renderer(device(), animated, pathTracer(), smallImage());
  renderer.setFrame(10);
  renderer.render(4);
  Scene still = lampScene();
  still.addInstance({.mesh = 1, .worldFromObject = Transform::translation({1, 2, 0})});
  // The tables of moving lights have more entries, so the random numbers differ, but not the geometry.
  Renderer expected(device(), still, pathTracer(), smallImage());
  expected.render(4);
  double difference = 0, total = 0;
  const std::vector<float> a = renderer.image().pixels, b = expected.image().pixels;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += static_cast<double>(a[i]) - b[i];
    total += b[i];
  }
  EXPECT_LT(std::abs(difference), 0.05 * total);
  EXPECT_THROW(renderer.setTransform(added, {}), UsageError);
}

TEST_F(ApiRenderer, BlursMotion) {
  Scene animated = lampScene();
  animated.addInstance(
      {.mesh = 1, .keyframes = {{.frame = 0, .translation = {-1, 1, 0}}, {.frame = 10, .translation = {1, 2, 0}}}});
  const auto blurred = [&](const std::optional<Shutter>& shutter, float frame) {
    Settings settings = smallImage();
    settings.shutter = shutter;
    Renderer renderer(device(), animated, pathTracer(), settings);
    renderer.setFrame(frame);
    // Compiles the program again, which keeps the shutter.
    Material coated = animated.material(0);
    coated.clearcoat = 1;
    renderer.setMaterial(0, coated);
    renderer.render(4);
    return renderer.image().pixels;
  };
  const std::vector<float> image = blurred(Shutter{2, 8}, 1);
  EXPECT_EQ(blurred(Shutter{0, 6}, 3), image) << "the same interval";
  EXPECT_NE(blurred(Shutter{3, 3}, 3), image);
  EXPECT_EQ(blurred(Shutter{3, 3}, 3), blurred({}, 6));
  EXPECT_THROW(blurred(Shutter{1, 0}, 0), UsageError);
  Settings settings = smallImage();
  settings.shutter = Shutter{0, 0.5};
  EXPECT_THROW(Renderer(device(), scene_, pathTracer(), settings), UsageError) << "nothing moves";
}

TEST_F(ApiRenderer, MovedInstancesKeepTheMotionOfOthers) {
  Scene animated = lampScene();
  animated.addInstance(
      {.mesh = 2, .keyframes = {{.frame = 0, .translation = {-1, 1, 0}}, {.frame = 10, .translation = {1, 2, 0}}}});
  Settings settings = smallImage();
  settings.outputs = {"motion"};
  const Transform moved = Transform::translation({0, 0.5f, 1});
  Renderer edited(device(), animated, pathTracer(), settings);
  edited.setFrame(5);
  edited.render(4);
  edited.setTransform(2, moved);
  edited.render(4);
  animated.setTransform(2, moved);
  Renderer expected(device(), animated, pathTracer(), settings);
  expected.setFrame(5);
  expected.render(4);
  const std::vector<float> motion = expected.film().layer("motion").values;
  EXPECT_THAT(motion, testing::Contains(testing::Gt(0.1f)));
  EXPECT_EQ(edited.film().layer("motion").values, motion);
  EXPECT_EQ(edited.image().pixels, expected.image().pixels);
}

TEST_F(ApiRenderer, KeepsTheFrameAcrossARebuild) {
  Scene animated = lampScene();
  animated.addInstance(
      {.mesh = 1, .keyframes = {{.frame = 0, .translation = {-1, 1, 0}}, {.frame = 10, .translation = {1, 2, 0}}}});
  Material coated = animated.material(0);
  coated.clearcoat = 1;
  Renderer edited(device(), animated, pathTracer(), smallImage());
  edited.setFrame(10);
  edited.setMaterial(0, coated);
  edited.render(4);
  animated.setMaterial(0, coated);
  Renderer expected(device(), animated, pathTracer(), smallImage());
  expected.render(4);
  EXPECT_NE(edited.image().pixels, expected.image().pixels);
  expected.setFrame(10);
  expected.render(4);
  EXPECT_EQ(edited.image().pixels, expected.image().pixels);
}

TEST_F(ApiRenderer, ResumesOnlyTheSameFrame) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "api_frame.qfilm";
  Scene animated = lampScene();
  animated.addInstance(
      {.mesh = 1, .keyframes = {{.frame = 0, .translation = {-1, 1, 0}}, {.frame = 10, .translation = {1, 2, 0}}}});
  Renderer renderer(device(), animated, pathTracer(), smallImage());
  renderer.setFrame(5);
  renderer.render(4);
  renderer.saveCheckpoint(file);
  renderer.setFrame(6);
  EXPECT_THROW(renderer.resume(file), FileError);
  renderer.setFrame(5);
  EXPECT_TRUE(renderer.resume(file));
  std::filesystem::remove(file);
}

TEST_F(ApiRenderer, ResumesFromACheckpoint) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "api_checkpoint.qfilm";
  std::filesystem::remove(file);
  renderer_.render(4);
  EXPECT_FALSE(renderer_.resume(file));
  EXPECT_EQ(renderer_.sampleCount(), 4) << "there is nothing to resume from";
  renderer_.render(4);
  renderer_.saveCheckpoint(file);

  Renderer second(device(), scene_, pathTracer(), smallImage());
  EXPECT_TRUE(second.resume(file));
  EXPECT_EQ(second.sampleCount(), 8u);
  second.render(4);
  EXPECT_EQ(second.image().pixels, rendered(scene_, smallImage(), 12));

  renderer_.setTransform(2, Transform::translation({0, 1, 0}));  // a different render
  const std::vector<float> before = image(8);
  EXPECT_THROW(renderer_.resume(file), FileError);
  EXPECT_EQ(renderer_.sampleCount(), 8);
  EXPECT_EQ(renderer_.image().pixels, before);
  std::filesystem::remove(file);
}

TEST_F(ApiRenderer, RejectsUnknownNames) {
  Settings settings = smallImage();
  settings.outputs = {"albdo"};
  EXPECT_THROW(Renderer(device(), scene_, pathTracer(), settings), UsageError);
  EXPECT_THROW(renderer_.image("albedo"), UsageError);  // exists, but was not requested
  settings = smallImage();
  settings.camera.reset();
  settings.cameraName = "Front";
  EXPECT_THROW(Renderer(device(), scene_, pathTracer(), settings), UsageError);
  settings = smallImage();
  settings.region = Region{40, 0, 20, 20};
  EXPECT_THROW(Renderer(device(), scene_, pathTracer(), settings), UsageError);
}

TEST_F(ApiRenderer, RegionsArePartsOfTheImage) {
  Settings settings = smallImage();
  settings.region = Region{10, 6, 16, 8};
  Renderer part(device(), scene_, pathTracer(), settings);
  part.render(4);
  renderer_.render(4);
  const Image whole = renderer_.image(), cut = part.image();
  ASSERT_EQ(cut.width, 16u);
  ASSERT_EQ(cut.height, 8u);
  for (std::uint32_t y = 0; y < 8; ++y)
    for (std::uint32_t x = 0; x < 16; ++x) EXPECT_EQ(cut.at(x, y), whole.at(x + 10, y + 6));
}

}  // namespace
}  // namespace quintet::test
