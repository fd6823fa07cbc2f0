// SPDX-License-Identifier: Apache-2.0
// Objects that were moved from, changes while a render is at work, and cancellation.
#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "scenes.h"

namespace quintet::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Settings tinyImage() { return {.width = 16, .height = 8, .camera = kCamera}; }

// Every function of an empty object throws UsageError that names the class.
void expectEmpty(const char* name, const std::vector<std::function<void()>>& calls) {
  for (std::size_t i = 0; i < calls.size(); ++i) {
    try {
      calls[i]();
      ADD_FAILURE() << name << ": call " << i << " did not throw";
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr(std::string("this ") + name + " is empty")) << i;
    }
  }
}

TEST(ApiEmptyObject, SceneThrows) {
  Scene scene = lampScene();
  const Scene moved = std::move(scene);
  EXPECT_EQ(moved.meshCount(), 3u);
  // NOLINTBEGIN(bugprone-use-after-move)
  expectEmpty("Scene", {[&] { scene.meshCount(); }, [&] { scene.name(); }, [&] { scene.bounds(); },
                        [&] { scene.report(); }, [&] { scene.addMaterial({}); }, [&] { scene.addLight({}); },
                        [&] { scene.addCamera({}); }, [&] { scene.addInstance({}); }, [&] { addSquare(scene, {}); },
                        [&] { scene.setMaterial(0, {}); }, [&] { scene.setTransform(0, {}); },
                        [&] { scene.setEnvironment(Environment{}); }, [&] { scene.findInstance("a"); },
                        [&] { scene.material(0); }, [&] { checkProgram(pathTracer(), &scene); },
                        [&] { Renderer(device(), scene, pathTracer(), tinyImage()); }});
  const Scene copy = scene;
  expectEmpty("Scene", {[&] { copy.meshCount(); }});
  scene = lampScene();
  // NOLINTEND(bugprone-use-after-move)
  EXPECT_EQ(scene.meshCount(), 3u) << "assignment gives it a scene again";
}

TEST(ApiEmptyObject, ProgramThrows) {
  Program program = Program::load("normals");
  const Program moved = std::move(program);
  EXPECT_EQ(moved.name(), "normals");
  const Program neverLoaded;
  for (const Program* empty :
       std::initializer_list<const Program*>{&program, &neverLoaded})  // NOLINT(bugprone-use-after-move)
    expectEmpty("Program", {[&] { empty->name(); }, [&] { empty->description(); }, [&] { empty->parameters(); },
                            [&] { empty->outputs(); }, [&] { checkProgram(*empty); }, [&] { Scene::of(*empty); },
                            [&] { Renderer(device(), lampScene(), *empty, tinyImage()); }});
}

TEST(ApiEmptyObject, RendererThrows) {
  Renderer renderer(device(), lampScene(), Program::load("normals"), tinyImage());
  Renderer moved = std::move(renderer);
  moved.render(1);
  // NOLINTBEGIN(bugprone-use-after-move)
  expectEmpty(
      "Renderer",
      {[&] { renderer.render(1); }, [&] { renderer.image(); }, [&] { renderer.film(); },
       [&] { renderer.sampleCount(); }, [&] { renderer.diagnostics(); }, [&] { renderer.explain(0, 0); },
       [&] { renderer.search(); }, [&] { renderer.setCamera(kCamera); }, [&] { renderer.setParameter("a", "1"); },
       [&] { renderer.setTransform(0, {}); }, [&] { renderer.setMaterial(0, {}); }, [&] { renderer.setFrame(0); },
       [&] { renderer.restart(); }, [&] { renderer.saveCheckpoint("a.qfilm"); }, [&] { renderer.resume("a.qfilm"); }});
  // NOLINTEND(bugprone-use-after-move)
  moved = Renderer(device(), lampScene(), Program::load("normals"), tinyImage());
  EXPECT_EQ(moved.sampleCount(), 0);
}

TEST(ApiEmptyObject, FilmThrows) {
  Renderer renderer(device(), lampScene(), Program::load("normals"), tinyImage());
  renderer.render(1);
  Film film = renderer.film();
  const Film moved = std::move(film);
  EXPECT_EQ(moved.width(), 16u);
  const Film neverRendered;
  for (const Film* empty :
       std::initializer_list<const Film*>{&film, &neverRendered})  // NOLINT(bugprone-use-after-move)
    expectEmpty("Film", {[&] { empty->width(); }, [&] { empty->height(); }, [&] { empty->sampleCount(); },
                         [&] { empty->layers(); }, [&] { empty->image(); }, [&] { empty->layer("albedo"); },
                         [&] { empty->metadata(); }, [&] { empty->write("a.png"); }});
}

TEST(ApiEmptyObject, DeviceThrows) {
  Device one;
  const Device moved = std::move(one);
  EXPECT_NE(moved.name(), "");
  // NOLINTBEGIN(bugprone-use-after-move)
  expectEmpty("Device", {[&] { one.name(); }, [&] { one.driver(); }, [&] { one.info(); }, [&] { one.infos(); },
                         [&] { Renderer(one, lampScene(), Program::load("normals"), tinyImage()); }});
  // NOLINTEND(bugprone-use-after-move)
}

class ApiBusyRenderer : public testing::Test {
 protected:
  Renderer renderer{device(), lampScene(), pathTracer(), tinyImage()};
};

// A change during a render would discard samples that the limit counts.
TEST_F(ApiBusyRenderer, RejectsChangesByTheProgressFunction) {
  const std::vector<std::function<void()>> changes{[&] { renderer.setCamera(kCamera); },
                                                   [&] {
                                                     renderer.setTransform(0, Transform::translation({0, 1, 0}));
                                                   },
                                                   [&] { renderer.setMaterial(0, {}); },
                                                   [&] { renderer.setParameter("bounces", "2"); },
                                                   [&] { renderer.setFrame(0); },
                                                   [&] { renderer.restart(); },
                                                   [&] { renderer.resume("missing.qfilm"); },
                                                   [&] { renderer.render(1); },
                                                   [&] { renderer.explain(0, 0); },
                                                   [&] { renderer.search(); }};
  std::size_t rejected = 0;
  const RenderReport report = renderer.render({.samples = 32}, [&](const Progress& p) {
    for (const std::function<void()>& change : changes)
      rejected += messageOf(change).find("progress function") != std::string::npos;
    if (p.samples >= 16) {
      EXPECT_EQ(renderer.image().width, 16u) << "an image can be read";
    }
    return true;
  });
  EXPECT_GT(rejected, 0u);
  EXPECT_EQ(rejected % changes.size(), 0u);
  EXPECT_EQ(report.samples, 32);
  EXPECT_EQ(report.reason, StopReason::samples);
  const std::vector<float> undisturbed = rendered(lampScene(), tinyImage(), 32);
  EXPECT_EQ(renderer.image().pixels, undisturbed);
  renderer.setCamera(kCamera);
  EXPECT_EQ(renderer.render(16).samples, 16) << "changes are possible after the render";
}

TEST_F(ApiBusyRenderer, ContinuesAfterAnExceptionOfTheProgressFunction) {
  const auto fail = [](const Progress& p) -> bool {
    if (p.samples >= 16) throw std::runtime_error("of the application");
    return true;
  };
  EXPECT_THROW(renderer.render({.samples = 64}, fail), std::runtime_error);
  const double done = renderer.sampleCount();
  EXPECT_GE(done, 16);
  EXPECT_LT(done, 64);
  EXPECT_EQ(renderer.render({.samples = 64}).samples, 64) << "the samples so far count";
  EXPECT_EQ(renderer.image().pixels, rendered(lampScene(), tinyImage(), 64));
}

// Each sample takes long: a batch of 16 samples is not completed.
TEST(ApiCancellation, EndsALongBatch) {
  const Program heavy = constantProgram("vec4(work(), 1.0)", R"(
vec3 work() {
  float x = 0.5;
  for (int i = 0; i < 200000; ++i) x = fract(x * 1.7 + 0.3);
  return vec3(x);
}
)");
  Settings settings{.width = 256, .height = 128, .camera = kCamera};
  Renderer renderer(device(), lampScene(), heavy, settings);
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> canceled;
  const RenderReport report = renderer.render({.samples = 64}, [&](const Progress&) {
    if (!canceled) canceled = Clock::now();
    return false;
  });
  const double seconds = std::chrono::duration<double>(Clock::now() - canceled.value()).count();
  EXPECT_EQ(report.reason, StopReason::canceled);
  EXPECT_LT(report.samples, 64);
  if (device().info().kind == "CPU") {
    EXPECT_LT(seconds, 10) << "a batch takes minutes";
  }
}

TEST(ApiCancellation, EndsTheConstruction) {
  Settings settings = tinyImage();
  int asked = 0;
  settings.canceled = [&] { return ++asked > 0; };
  EXPECT_THROW(Renderer(device(), lampScene(), pathTracer(), settings), CanceledError);
  EXPECT_GT(asked, 0);
  bool cancel = false;
  settings.canceled = [&] { return cancel; };
  Renderer renderer(device(), lampScene(), pathTracer(), settings);
  EXPECT_EQ(renderer.render(4).samples, 4);
  cancel = true;
  EXPECT_EQ(renderer.render({.samples = 1000}).reason, StopReason::canceled);
  cancel = false;
  EXPECT_EQ(renderer.render({.samples = 64}).samples, 64);
}

TEST(ApiCancellation, EndsLoading) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("quintet_canceled_" + std::to_string(::getpid()) + ".scene.toml");
  std::ofstream(file) << "[[material]]\nname = \"a\"\n";
  int asked = 0;
  EXPECT_THROW(Scene::load(file, {.canceled = [&] { return ++asked > 0; }}), CanceledError);
  EXPECT_GT(asked, 0);
  EXPECT_EQ(Scene::load(file, {.canceled = [] { return false; }}).material(0).name, "a");
  std::filesystem::remove(file);
  EXPECT_THROW(Scene::load("missing.glb", {.canceled = [] { return false; }}), FileError);
}

TEST(ApiMessages, NameObjectsWithoutAName) {
  Scene scene;
  addSquare(scene, {});
  addSquare(scene, {});
  const std::array<Float3, 2> two{};
  EXPECT_THAT(messageOf([&] { scene.addMesh({.positions = two}); }),
              HasSubstr("mesh 2 of the scene in memory: triangles"));
  EXPECT_THAT(messageOf([&] {
                scene.addLight({.intensity = {-1, 0, 0}});
              }),
              HasSubstr("light 0 of the scene in memory: the"));
  EXPECT_THAT(messageOf([&] { scene.addCamera({.verticalFov = 4}); }),
              HasSubstr("camera 0 of the scene in memory: verticalFov"));
  EXPECT_THAT(messageOf([&] { scene.addTexture({.width = 1, .height = 1, .channels = 7}); }),
              HasSubstr("texture 0 of the scene in memory: 7 channels"));
  EXPECT_THAT(messageOf([&] { Renderer(device(), scene, pathTracer(), {.width = 4, .height = 4, .cameraName = "x"}); }),
              HasSubstr("scene in memory"));
  Renderer empty(device(), Scene(), pathTracer(), tinyImage());
  EXPECT_THAT(empty.render(1).warnings, testing::Contains(HasSubstr("scene in memory: the scene has no surfaces")));
  EXPECT_EQ(Program::fromSource("", "").name(), "program");
}

TEST(ApiMessages, TexturesNeedCoordinates) {
  Scene scene;
  const std::array<std::uint8_t, 4> pixel{};
  const int texture = scene.addTexture({.width = 1, .height = 1, .pixels = std::span<const std::uint8_t>(pixel)});
  const Material textured{.name = "wood", .roughness = 1, .normalTexture = {.texture = texture, .uvSet = 1}};
  const int material = scene.addMaterial(textured);
  const std::array<Float2, 4> uv{};
  EXPECT_THAT(messageOf([&] {
                scene.addMesh({.positions = kCorners, .indices = kSquare, .uv0 = uv, .material = material}, "table");
              }),
              HasSubstr("mesh 'table': uv1 is missing, which normalTexture of material 'wood' uses"));
  EXPECT_EQ(scene.meshCount(), 0u);
  scene.addMesh({.positions = kCorners, .indices = kSquare, .uv1 = uv, .material = material});
  const int plain = scene.addMaterial({.name = "plain"});
  scene.addInstance({.mesh = scene.addMesh({.positions = kCorners, .indices = kSquare, .material = plain})});
  EXPECT_THAT(messageOf([&] { scene.setMaterial(plain, textured); }), HasSubstr("normalTexture of material 'wood'"));
  EXPECT_EQ(scene.material(plain).name, "plain");
  Renderer renderer(device(), scene, Program::load("normals"), tinyImage());
  EXPECT_THAT(messageOf([&] { renderer.setMaterial(plain, textured); }), HasSubstr("uv1 is missing"));
  renderer.setMaterial(plain, {.name = "other"});
}

TEST(ApiMessages, ErrorsOfOneKindHaveOneType) {
  for (const char* missing : {"missing.rt.glsl", "./missing", "/missing/program.rt.glsl", "/missing/program"})
    EXPECT_THROW(Program::load(missing), FileError) << missing;
  EXPECT_THROW(Program::load("pathtracr"), UsageError) << "a name of a built-in program";
  EXPECT_THROW(Film::merge({}), UsageError);
}

TEST(ApiMessages, ValuesThatMeanNothingAreErrors) {
  Renderer renderer(device(), lampScene(), pathTracer(), tinyImage());
  EXPECT_THAT(messageOf([&] { renderer.setFrame(3); }), HasSubstr("neither keyframes nor an animation"));
  renderer.setFrame(0);
  renderer.render(1);
  for (const double exposure :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 101.0})
    EXPECT_THAT(messageOf([&] { renderer.film().write("never.png", {.exposure = exposure}); }), HasSubstr("exposure"));
  Settings settings = tinyImage();
  settings.print = Region{16, 0, 1, 1};  // the path tracer prints nothing
  EXPECT_THAT(messageOf([&] { Renderer(device(), lampScene(), pathTracer(), settings); }),
              HasSubstr("16,0,1,1 to print are outside"));
}

TEST(ApiMessages, TheImageIsALayer) {
  Renderer renderer(device(), lampScene(), pathTracer(), tinyImage());
  renderer.render(4);
  const Film film = renderer.film();
  const Layer color = film.layer("color");
  EXPECT_EQ(color.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
  EXPECT_EQ(color.values, film.image().pixels);
  EXPECT_THAT(messageOf([&] { film.layer("colr"); }), HasSubstr("not found"));
}

}  // namespace
}  // namespace quintet::test
