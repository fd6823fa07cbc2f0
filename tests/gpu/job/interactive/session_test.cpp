// SPDX-License-Identifier: Apache-2.0
// Sessions on a device, with a clock that the test sets: previews, refinement to the film of a render, edits, undo,
// picking, reload.
#include "job/interactive/session.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "base/error.h"
#include "base/file.h"
#include "io/codec.h"
#include "job/explanation_diff.h"
#include "job/films.h"
#include "job/interactive/command_json.h"
#include "job/test_engine.h"
#include "program/load.h"
#include "temp_folder.h"

namespace quintet::job::interactive {
namespace {

constexpr const char* kScene =
    "[[material]]\nname = \"red\"\nbase_color = [0.8, 0.1, 0.1]\nmetallic = 0.0\n"
    "[[mesh]]\nname = \"box\"\nshape = \"cube\"\nmaterial = \"red\"\n"
    "[[instance]]\nof = \"box\"\nname = \"left\"\n"
    "[[instance]]\nof = \"box\"\nname = \"right\"\ntranslate = [3.0, 0.0, 0.0]\n"
    "[[camera]]\nname = \"front\"\nlook_from = [1, 2, 8]\nlook_at = [1, 0, 0]\n";

// With lights and an environment of one color.
std::string litScene() {
  return std::string(kScene) +
         "[[material]]\nname = \"glow\"\nemissive = [1.0, 0.5, 0.25]\n"
         "[[mesh]]\nname = \"bulb\"\nshape = \"cube\"\nmaterial = \"glow\"\n"
         "[[instance]]\nof = \"bulb\"\nname = \"bulb\"\ntranslate = [-3.0, 0.0, 0.0]\n"
         "[[light]]\nname = \"lamp\"\ntype = \"point\"\nposition = [0, 4, 4]\nintensity = 20.0\n"
         "[[light]]\nname = \"spot\"\ntype = \"spot\"\nposition = [3, 5, 0]\ndirection = [0, -1, 0]\n"
         "outer_angle = 30.0\nintensity = 50.0\n"
         "[environment]\ncolor = [0.1, 0.2, 0.3]\n";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

// Counts the expensive steps of the work.
struct StageObserver : Observer {
  void stage(const std::string& text) override {
    compilations += text.starts_with("compiling") ? 1 : 0;
    builds += text.starts_with("building") ? 1 : 0;
  }
  int compilations = 0, builds = 0;
};

class SessionTest : public testing::Test {
 protected:
  SessionTest() { writeFile(folder_ / "a.scene.toml", kScene); }

  RenderRequest request(std::uint32_t samples = 6) const {
    RenderRequest request;
    request.scene = folder_ / "a.scene.toml";
    request.size = {40, 24};
    request.seed = 7;
    request.limits.samples = samples;
    return request;
  }
  std::unique_ptr<Session> makeSession(const RenderRequest& request, const std::string& program = "pathtracer") {
    return std::make_unique<Session>(
        testEngine(), SessionRequest{program, request}, [this] { return now_; }, observer_);
  }
  // The sums of output 0 of an ordinary render.
  std::vector<shared::FixedSum> reference(const RenderRequest& request, const std::string& program = "pathtracer") {
    RenderJob job(testEngine(), resolve(request, program::loadProgram(program)), observer_);
    return job.run(request.limits, observer_).film->plane(0).sums;
  }
  static std::vector<shared::FixedSum> sums(const Session& session) { return session.result().film->plane(0).sums; }

  // What `quintet explain-pixel` records of a render.
  PixelExplanation explainRender(const RenderRequest& request, uvec2 pixel, std::uint32_t sample,
                                 const std::string& program = "pathtracer") {
    const program::Program loaded = program::loadProgram(program);
    RenderJob job(testEngine(), resolve(requestForPixel(request, loaded, pixel), loaded), observer_);
    return PixelExplainer(testEngine(), job).explain(pixel, sample, observer_);
  }

  template <class T>
  static const T* find(const std::vector<Event>& events) {
    for (const Event& event : events)
      if (const T* found = std::get_if<T>(&event)) return found;
    return nullptr;
  }

  // Expects the same values, also the last bits, except members of payloads that the program has not written.
  static void expectEqual(const PixelExplanation& a, const PixelExplanation& b) {
    const ExplanationDiff diff = diffExplanations(a, b, {.relative = 0.0f, .absolute = 0.0f});
    EXPECT_TRUE(diff.outputs.empty());
    for (const ExplanationDifference& fact : diff.facts)
      ADD_FAILURE() << fact.location << ": " << fact.a << ", " << fact.b;
    if (diff.first) ADD_FAILURE() << diff.first->location << ": " << diff.first->a << ", " << diff.first->b;
    EXPECT_GT(diff.equalEvents, 1u);
  }
  // All lines that these events have.
  static std::vector<PrintedLine> printedLines(const std::vector<Event>& events) {
    std::vector<PrintedLine> lines;
    for (const Event& event : events)
      if (const auto* printed = std::get_if<LinesPrinted>(&event))
        lines.insert(lines.end(), printed->printed.lines.begin(), printed->printed.lines.end());
    return lines;
  }

  const quintet::test::TempFolder folder_;
  double now_ = 100;
  StageObserver observer_;
};

TEST_F(SessionTest, RefinesToTheFilmOfARender) {
  const auto session = makeSession(request());
  const std::vector<Event> events = session->refine();
  const auto* image = find<ImageUpdated>(events);
  ASSERT_NE(image, nullptr);
  EXPECT_EQ(image->samples, 6u);
  EXPECT_EQ(image->size, uvec2(40, 24));
  EXPECT_EQ(image->factor, 1u);
  EXPECT_TRUE(image->complete);
  EXPECT_TRUE(test::equalSums(sums(*session), reference(request())));
  EXPECT_EQ(session->image().width, 40u);
  EXPECT_EQ(session->image().type, io::PixelType::u8);
  EXPECT_EQ(session->secondsUntilWork(), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(session->step(1).empty());
}

TEST_F(SessionTest, PreviewsWhileCommandsArrive) {
  const auto session = makeSession(request());
  EXPECT_FALSE(session->hasFullSize());
  session->refine();
  EXPECT_TRUE(session->hasFullSize());
  session->apply(Orbit{20, 0});
  EXPECT_FALSE(session->hasFullSize());
  EXPECT_EQ(session->secondsUntilWork(), 0);
  std::vector<Event> events = session->step(0.01);
  EXPECT_NE(find<Restarted>(events), nullptr);
  const auto* preview = find<ImageUpdated>(events);
  ASSERT_NE(preview, nullptr);
  EXPECT_EQ(preview->samples, 1u);
  EXPECT_FALSE(preview->complete);
  EXPECT_EQ(preview->size, reducedSize({40, 24}, preview->factor));
  EXPECT_EQ(session->image().width, preview->size.x);
  EXPECT_TRUE(session->step(0.01).empty()) << "it waits for the next command";
  EXPECT_NEAR(session->secondsUntilWork(), 0.2, 1e-6);
  now_ += 0.25;
  EXPECT_EQ(session->secondsUntilWork(), 0);
  events = session->step(1000);
  const auto* image = find<ImageUpdated>(events);
  ASSERT_NE(image, nullptr);
  EXPECT_TRUE(image->complete);
  RenderRequest same = request();
  same.camera = session->state().camera;
  EXPECT_TRUE(test::equalSums(sums(*session), reference(same))) << "the preview leaves no trace";
}

// The first samples depend on the planned number.
TEST_F(SessionTest, SamplesAndSizesAreThoseOfTheRequest) {
  RenderRequest other = request(9);
  other.size = {30, 50};
  const auto session = makeSession(request());
  session->refine();
  session->apply(SetSamples{9});
  session->apply(SetSize{{30, 50}});
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), reference(other)));
  EXPECT_THROW(session->apply(SetSize{{30, 0}}), UsageError);
  EXPECT_EQ(session->state().size, uvec2(30, 50));
}

class SessionCamera : public SessionTest {};

TEST_F(SessionCamera, TheSizeOfAWindowIsNoStepOfUndo) {
  const auto session = makeSession(request());
  session->apply(SetExposure{1});
  session->apply(SetSize{{30, 50}, /*ofWindow=*/true});
  EXPECT_TRUE(session->canUndo());
  session->apply(Undo{});
  EXPECT_EQ(session->state().exposure, 0.0) << "the exposure was the last step";
  EXPECT_EQ(session->state().size, uvec2(30, 50)) << "the window has not changed";
  session->apply(SetSize{{20, 10}, /*ofWindow=*/true});
  EXPECT_TRUE(session->canRedo());
  session->apply(Redo{});
  EXPECT_EQ(session->state().exposure, 1.0);
  EXPECT_EQ(session->state().size, uvec2(20, 10));
}

TEST_F(SessionCamera, AnAutomaticCameraFollowsTheSize) {
  std::string scene = std::string(kScene).substr(0, std::string(kScene).find("[[camera]]"));
  writeFile(folder_ / "a.scene.toml", scene);
  const auto session = makeSession(request());
  session->step(1000);
  session->apply(SetSize{{21, 61}});
  EXPECT_NE(find<ImageUpdated>(session->step(0)), nullptr);
  // The scene is built again while the film is reduced, to another aspect ratio.
  const int builds = observer_.builds;
  session->apply(EditMaterial{"red", {{"transmission", {1}}, {"roughness", {0}}, {"emissive", {1, 0.5, 0.25}}}});
  EXPECT_NE(find<ImageUpdated>(session->step(0)), nullptr);
  EXPECT_EQ(observer_.builds, builds + 1);
  session->refine();
  scene.insert(scene.find("metallic"), "transmission = 1.0\nroughness = 0.0\nemissive = [1.0, 0.5, 0.25]\n");
  writeFile(folder_ / "a.scene.toml", scene);
  RenderRequest other = request();
  other.size = {21, 61};
  other.environment.source = "default";  // the session had it before the scene emitted light
  EXPECT_EQ(session->state().environment.source, "default");
  EXPECT_TRUE(test::equalSums(sums(*session), reference(other)));
}

// Without --size, the first camera decides it.
TEST_F(SessionCamera, TheSizeStaysWhenTheSceneIsBuiltAgain) {
  writeFile(folder_ / "a.scene.toml", std::string(kScene) + "aspect = 2.0\n");
  RenderRequest noHeight = request(1);
  noHeight.size = {40, 0};
  const auto session = makeSession(noHeight);
  session->refine();
  EXPECT_EQ(session->image().height, 20u);
  session->apply(Orbit{10, 0});  // this camera states no aspect ratio
  session->apply(EditMaterial{"red", {{"transmission", {1}}, {"roughness", {0}}}});  // builds the scene again
  const int builds = observer_.builds;
  session->refine();
  EXPECT_EQ(observer_.builds, builds + 1);
  EXPECT_EQ(session->image().width, 40u);
  EXPECT_EQ(session->image().height, 20u);
}

TEST_F(SessionCamera, AnAutomaticCameraStaysWhenInstancesMove) {
  writeFile(folder_ / "a.scene.toml", std::string(kScene).substr(0, std::string(kScene).find("[[camera]]")));
  const auto session = makeSession(request());
  session->apply(Move{"left", {0, 5, 0}});
  session->refine();
  const std::vector<shared::FixedSum> moved = sums(*session);
  for (const uvec2 size : {uvec2(21, 61), uvec2(40, 24)}) {
    session->apply(SetSize{size});
    session->refine();
  }
  EXPECT_TRUE(test::equalSums(sums(*session), moved));
  session->apply(EditMaterial{"red", {{"transmission", {1}}, {"roughness", {0}}}});  // builds the scene again
  session->refine();
  session->apply(Undo{});
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), moved));
}

// They compile a pipeline for each set of features.
class SessionEdits : public SessionTest {};

// Each edit gives the film of a scene file that states it. `compilations` and `builds`: how often the program is
// compiled and the scene is built.
struct SceneEdit {
  const char* name;
  Command command;
  std::string from, to;
  int compilations = 0, builds = 0;
};

TEST_F(SessionEdits, GiveTheFilmOfTheEditedScene) {
  const std::vector<SceneEdit> edits{
      {"base color", EditMaterial{"red", {{"baseColor", {0.25, 0.5, 1}}}}, "[0.8, 0.1, 0.1]", "[0.25, 0.5, 1.0]"},
      {"emission", EditMaterial{"glow", {{"emissive", {0.5, 2, 1}}}}, "[1.0, 0.5, 0.25]", "[0.5, 2.0, 1.0]"},
      {"first emission", EditMaterial{"red", {{"emissive", {1, 1, 0.5}}}}, "metallic = 0.0",
       "metallic = 0.0\nemissive = [1.0, 1.0, 0.5]"},
      {"intensity", EditLight{"lamp", {{"intensity", {8}}}}, "intensity = 20.0", "intensity = 8.0"},
      {"color", EditLight{"lamp", {{"color", {1, 0.5, 0.25}}}}, "intensity = 20.0",
       "intensity = 20.0\ncolor = [1.0, 0.5, 0.25]"},
      {"position", EditLight{"lamp", {{"position", {2, 3, 4}}}}, "[0, 4, 4]", "[2, 3, 4]"},
      {"direction", EditLight{"spot", {{"direction", {0, 0, -3}}}}, "[0, -1, 0]", "[0, 0, -1]"},
      {"light off", EditLight{"spot", {{"on", {0}}}}, "intensity = 50.0", "intensity = 0.0"},
      {"environment", SetEnvironment{.source = "0.5,0.25,0.125", .intensity = {}, .rotation = {}, .on = {}},
       "[0.1, 0.2, 0.3]", "[0.5, 0.25, 0.125]"},
      {"environment off", SetEnvironment{.source = {}, .intensity = {}, .rotation = {}, .on = false},
       "color = [0.1, 0.2, 0.3]", "none = true", 1},
      {"move", Move{"bulb", {0, 0, 2}}, "[-3.0, 0.0, 0.0]", "[-3.0, 0.0, 2.0]"},
      {"clear coat", EditMaterial{"red", {{"clearcoat", {1}}}}, "metallic = 0.0", "metallic = 0.0\nclearcoat = 1.0", 1},
      {"sheen", EditMaterial{"red", {{"sheenColor", {1, 0.5, 1}}, {"sheenRoughness", {0.5}}}}, "metallic = 0.0",
       "metallic = 0.0\nsheen_color = [1.0, 0.5, 1.0]\nsheen_roughness = 0.5", 1},
      {"anisotropy", EditMaterial{"red", {{"anisotropy", {0.5}}, {"anisotropyRotation", {0}}}}, "metallic = 0.0",
       "metallic = 0.0\nanisotropy = 0.5", 1, 1},
      {"film", EditMaterial{"red", {{"iridescence", {1}}, {"iridescenceThicknessMaximum", {300}}}}, "metallic = 0.0",
       "metallic = 0.0\niridescence = 1.0\niridescence_thickness_maximum = 300.0", 1},
      {"clear pane", EditMaterial{"red", {{"transmission", {1}}, {"roughness", {0}}}}, "metallic = 0.0",
       "metallic = 0.0\ntransmission = 1.0\nroughness = 0.0", 1, 1}};
  writeFile(folder_ / "a.scene.toml", litScene());
  const auto session = makeSession(request(4));
  session->refine();
  const std::vector<shared::FixedSum> before = sums(*session);
  for (const SceneEdit& edit : edits) {
    writeFile(folder_ / "a.scene.toml", replaced(litScene(), edit.from, edit.to));
    const std::vector<shared::FixedSum> expected = reference(request(4));
    EXPECT_FALSE(test::equalSums(before, expected)) << edit.name;
    const StageObserver start = observer_;
    session->apply(edit.command);
    session->refine();
    EXPECT_EQ(observer_.compilations - start.compilations, edit.compilations) << edit.name;
    EXPECT_EQ(observer_.builds - start.builds, edit.builds) << edit.name;
    EXPECT_TRUE(test::equalSums(sums(*session), expected)) << edit.name;
    session->apply(Undo{});
    session->refine();
    EXPECT_TRUE(test::equalSums(sums(*session), before)) << edit.name;
  }
}

// Keyframes set the position of the light and the roughness of the material.
TEST_F(SessionTest, RejectsEditsOfAnimatedProperties) {
  writeFile(folder_ / "a.scene.toml",
            litScene() +
                "[[light]]\nname = \"moving\"\ntype = \"point\"\nposition = [0, 4, 4]\nintensity = 5.0\n"
                "keyframes = [{ time = 0.0, position = [0, 4, 4] }, { time = 1.0, position = [4, 4, 4] }]\n"
                "[[material]]\nname = \"polished\"\nroughness = 0.2\n"
                "keyframes = [{ time = 0.0, roughness = 0.2 }, { time = 1.0, roughness = 0.8 }]\n");
  const auto session = makeSession(request());
  EXPECT_THROW(session->apply(EditMaterial{"polished", {{"roughness", {0.5}}}}), UsageError);
  EXPECT_THROW(session->apply(EditLight{"moving", {{"position", {1, 1, 1}}}}), UsageError);
  EXPECT_FALSE(session->canUndo());
  session->apply(EditMaterial{"polished", {{"baseColor", {0.1, 0.8, 0.1}}}});
  session->apply(EditLight{"moving", {{"intensity", {2}}}});
  EXPECT_TRUE(session->canUndo());
}

// The members of a JSON object are read in alphabetical order.
TEST_F(SessionTest, LightPropertiesDoNotDependOnTheirOrder) {
  writeFile(folder_ / "a.scene.toml", replaced(litScene(), "intensity = 20.0", "intensity = 0.0"));
  const auto session = makeSession(request(1));
  const auto apply = [&](const std::string& json) { session->apply(parseCommand(sessionSchema().readCommand(json))); };
  apply(R"({"do":"light","name":"lamp","color":[1,0,0],"intensity":5})");
  EXPECT_EQ(session->light(0).light.intensity, vec3(5, 0, 0));
  apply(R"({"do":"light","name":"spot","innerConeAngle":40,"outerConeAngle":60})");
  EXPECT_NEAR(session->light(1).light.innerConeAngle, glm::radians(40.0f), 1e-6f);
  apply(R"({"do":"light","name":"spot","innerConeAngle":10,"outerConeAngle":20})");
  EXPECT_NEAR(session->light(1).light.outerConeAngle, glm::radians(20.0f), 1e-6f);
  EXPECT_THAT([&] { apply(R"({"do":"light","name":"spot","innerConeAngle":21})"); },
              testing::ThrowsMessage<UsageError>(testing::HasSubstr("lights[1] 'spot': the cone angles")));
  EXPECT_NEAR(session->light(1).light.innerConeAngle, glm::radians(10.0f), 1e-6f);
}

TEST_F(SessionTest, TheEnvironmentTurnsInPlace) {
  const auto session = makeSession(request());  // the default environment, an image
  const auto film = [&](const SetEnvironment& command) {
    session->apply(command);
    session->refine();
    return sums(*session);
  };
  RenderRequest other = request();
  other.environment = {.source = "default", .intensity = 0.5f, .rotation = 90.0f};
  const StageObserver start = observer_;
  EXPECT_TRUE(test::equalSums(film({.source = {}, .intensity = 0.5f, .rotation = 90.0f, .on = {}}), reference(other)));
  other.environment.source = "0.5,1,2";
  EXPECT_TRUE(
      test::equalSums(film({.source = "0.5,1,2", .intensity = {}, .rotation = {}, .on = {}}), reference(other)));
  other.environment.source = "none";
  film({.source = {}, .intensity = {}, .rotation = {}, .on = false});
  EXPECT_TRUE(test::equalSums(sums(*session), reference(other)));
  other.environment.source = "default";
  EXPECT_TRUE(
      test::equalSums(film({.source = "default", .intensity = {}, .rotation = {}, .on = true}), reference(other)));
  EXPECT_EQ(observer_.builds - start.builds, 4) << "only the references build scenes";
  EXPECT_THROW(session->apply(SetEnvironment{.source = "missing.hdr", .intensity = {}, .rotation = {}, .on = {}}),
               FileError);
  EXPECT_THROW(session->apply(SetEnvironment{.source = {}, .intensity = -1.0f, .rotation = {}, .on = {}}), UsageError);
}

TEST_F(SessionTest, ShowsAnotherEnvironmentImage) {
  io::Image sky = io::makeImage(4, 2, 3, io::PixelType::f32, io::ColorEncoding::linear);
  std::ranges::fill(sky.samples<float>(), 0.5f);
  sky.samples<float>()[3] = 4.0f;
  io::writeImage(folder_ / "sky.hdr", sky);
  RenderRequest other = request();
  other.environment.source = (folder_ / "sky.hdr").string();
  const auto session = makeSession(request());
  session->refine();
  session->apply(SetEnvironment{.source = other.environment.source, .intensity = {}, .rotation = {}, .on = {}});
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), reference(other)));
}

TEST_F(SessionTest, ShowsAnotherProgram) {
  const auto session = makeSession(request());
  session->apply(SetParameter{"bounces", "1"});
  session->refine();
  const std::vector<shared::FixedSum> before = sums(*session);
  session->apply(SetProgram{"normals"});
  EXPECT_EQ(session->program().name, "normals");
  EXPECT_EQ(session->state().output, "color");
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), reference(request(), "normals")));
  EXPECT_THROW(session->apply(SetProgram{"nromals"}), UsageError);
  EXPECT_EQ(session->program().name, "normals");
  session->apply(Undo{});
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), before));
}

TEST_F(SessionTest, AProgramThatAccumulatesLeavesTheFrame) {
  writeFile(folder_ / "a.scene.toml",
            replaced(kScene, "translate = [3.0, 0.0, 0.0]",
                     "keyframes = [{ frame = 0 }, { frame = 8, translate = [4.0, 2.0, 0.5] }]"));
  const auto session = makeSession(request(), "lessons/09_progressive");
  session->refine();
  session->apply(SetProgram{"pathtracer"});
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), reference(request())));
}

TEST_F(SessionTest, AProgramThatAccumulatesSuspendsTheShutter) {
  writeFile(folder_ / "a.scene.toml",
            replaced(kScene, "translate = [3.0, 0.0, 0.0]",
                     "keyframes = [{ frame = 0 }, { frame = 8, translate = [4.0, 2.0, 0.5] }]"));
  RenderRequest blurred = request();
  blurred.shutter = ShutterRequest{0, 4};
  const auto session = makeSession(blurred);
  session->refine();
  const std::vector<shared::FixedSum> before = sums(*session);
  EXPECT_FALSE(test::equalSums(before, reference(request())));
  session->apply(SetProgram{"lessons/09_progressive"});
  session->refine();
  EXPECT_EQ(session->program().accumulation, program::Accumulation::program);
  session->apply(SetProgram{"pathtracer"});
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), before)) << "the shutter is back";
  session->apply(Undo{});
  session->apply(Undo{});
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), before));
}

class SessionPicks : public SessionTest {};

TEST_F(SessionPicks, WhatIsVisible) {
  writeFile(folder_ / "a.scene.toml", litScene());  // several geometries, whose hit records depend on the ray types
  const auto session = makeSession(request());
  session->apply(SetCamera{{.lookFrom = vec3(3, 0, 8), .lookAt = vec3(3, 0, 0)}});
  session->refine();
  const std::vector<shared::FixedSum> before = sums(*session);
  const std::optional<Pick> picked = session->pick({20, 12});
  ASSERT_TRUE(picked);
  EXPECT_EQ(session->instanceNames().at(picked->instance), "right");
  EXPECT_EQ(session->materialNames().at(picked->material), "red");
  EXPECT_EQ(picked->geometry, 0u);
  const Bounds3 bounds = session->bounds("right");
  EXPECT_NEAR(picked->position.z, bounds.max.z, 1e-5f);
  // The ray goes through the center of the pixel, which is half a pixel right of and below that of the image of 40x24.
  const float halfHeight = std::tan(0.5f * session->camera().verticalFov) * (8.0f - bounds.max.z);
  EXPECT_NEAR(picked->position.x, 3 + halfHeight / 24, 1e-4f);
  EXPECT_NEAR(picked->position.y, -halfHeight / 24, 1e-4f);
  EXPECT_NEAR(picked->distance, glm::length(picked->position - vec3(3, 0, 8)), 1e-4f);
  for (const vec3& normal : {picked->normal, picked->geometricNormal})
    EXPECT_LT(glm::length(normal - vec3(0, 0, 1)), 1e-5f);
  EXPECT_TRUE(picked->front);
  EXPECT_FALSE(session->pick({0, 0})) << "the background";
  EXPECT_THROW(session->pick({40, 0}), UsageError);
  EXPECT_TRUE(test::equalSums(sums(*session), before)) << "picking keeps the film";
  session->apply(Move{"right", {0, 0, 1}});
  EXPECT_NEAR(session->pick({20, 12})->distance, picked->distance - 1, 1e-3f) << "edits are picked at once";
  session->apply(Undo{});
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), before));
}

// A surface close to the camera, and a lens: picking uses its center.
TEST_F(SessionPicks, ThroughTheCenterOfTheLens) {
  const auto session = makeSession(request());
  session->apply(SetCamera{{.lookFrom = vec3(0.1f, 0.1f, 1.2f), .lookAt = vec3(0.1f, 0.1f, 0)}});
  const std::optional<Pick> pinhole = session->pick({20, 12});
  session->apply(SetLens{.apertureRadius = 0.1f, .focusDistance = 5.0f});
  const std::optional<Pick> lens = session->pick({20, 12});
  ASSERT_TRUE(pinhole && lens);
  EXPECT_NEAR(pinhole->distance, 0.2f, 1e-2f) << "the front of the cube of 2 m";
  EXPECT_LT(glm::length(lens->position - pinhole->position), 1e-5f);
}

// The path tracer has two ray types and the lesson one, of a program that intersects the boxes itself.
TEST_F(SessionPicks, SolidsAndBoxes) {
  writeFile(folder_ / "a.scene.toml",
            "[[material]]\nname = \"clay\"\n"
            "[[spheres]]\nname = \"ball\"\nmaterial = \"clay\"\nitems = [{ center = [0, 0, 0], radius = 1.5 }]\n");
  const auto session = makeSession(request());
  session->apply(SetCamera{{.lookFrom = vec3(0, 0, 8), .lookAt = vec3(0, 0, 0)}});
  const std::optional<Pick> ball = session->pick({20, 12});
  ASSERT_TRUE(ball);
  EXPECT_EQ(session->materialNames().at(ball->material), "clay");
  EXPECT_NEAR(glm::length(ball->position), 1.5f, 1e-4f);
  EXPECT_LT(glm::length(ball->normal - ball->position / 1.5f), 1e-4f);

  writeFile(folder_ / "a.scene.toml",
            "[[custom]]\nname = \"boxes\"\nboxes = [{ min = [-9, -9, -9], max = [-8, -8, -8] }, "
            "{ min = [-1, -1, -1], max = [1, 1, 1] }]\n");
  const auto lesson = makeSession(request(1), "lessons/12_box");
  lesson->apply(SetCamera{{.lookFrom = vec3(0, 0, 9), .lookAt = vec3(0, 0, 0)}});
  lesson->refine();
  const std::optional<Pick> picked = lesson->pick({20, 12});
  ASSERT_TRUE(picked);
  EXPECT_NEAR(picked->position.z, 1, 1e-4f);
  EXPECT_EQ(picked->primitive, 1u);
  EXPECT_TRUE(picked->front);
  // Seen obliquely, the pixels show three faces.
  const vec3 eye(6, 5, 4);
  lesson->apply(SetCamera{{.lookFrom = eye, .lookAt = vec3(0.3f, 0.2f, 0.1f)}});
  const scene::Camera view = lesson->camera();
  vec3 seen(0.0f);
  for (std::uint32_t x = 12; x < 30; x += 3)
    for (std::uint32_t y = 6; y < 20; y += 3) {
      const vec2 plane = std::tan(0.5f * view.verticalFov) / 24.0f * vec2(2, -2) * (vec2(x, y) + 0.5f - vec2(20, 12));
      const vec3 d = vec3(view.worldFromCamera * vec4(plane, -1.0f, 0.0f));
      const vec3 entries = (1.0f - eye) / d, exits = (-1.0f - eye) / d;  // the slabs of the box [-1, 1]³; d is negative
      const float entry = std::max({entries.x, entries.y, entries.z}), exit = std::min({exits.x, exits.y, exits.z});
      if (exit < entry + 0.1f) continue;
      const std::optional<Pick> side = lesson->pick({x, y});
      ASSERT_TRUE(side) << x << " " << y;
      EXPECT_LT(glm::length(side->position - (eye + entry * d)), 1e-4f) << x << " " << y;
      seen += vec3(glm::equal(entries, vec3(entry)));
    }
  EXPECT_GT(std::min({seen.x, seen.y, seen.z}), 0.0f);
  lesson->apply(SetCamera{{.lookFrom = vec3(0, 0, 9), .lookAt = vec3(0, 0, 0)}});
  lesson->refine();
  const std::vector<std::byte> image = lesson->result().film->image(0).data;
  lesson->pick({20, 12});
  lesson->apply(SetSamples{2});
  lesson->apply(SetSamples{1});
  lesson->refine();
  EXPECT_EQ(lesson->result().film->image(0).data, image) << "the program still finds its hit groups";
}

// They compile programs that record their rays.
class SessionExplains : public SessionTest {};

TEST_F(SessionExplains, ASampleAsARender) {
  const auto session = makeSession(request());
  session->step(0.01);  // a preview: its size and its film do not matter
  const uvec2 pixel(17, 12);
  for (const std::uint32_t sample : {0u, 5u})
    expectEqual(session->explain(pixel, sample), explainRender(request(), pixel, sample));
  const PixelExplanation explanation = session->explain(pixel, 5);
  EXPECT_GT(explanation.outputs.at(0).value.x, 0.0f) << "the pixel shows the box";
  const std::uint64_t restarts = session->restarts();
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), reference(request()))) << "it leaves the film as it is";
  EXPECT_EQ(session->restarts(), restarts);
  EXPECT_THROW(session->explain({40, 0}, 0), UsageError);
  EXPECT_THROW(session->explain(pixel, 6), UsageError);
}

TEST_F(SessionExplains, TheEditedScene) {
  const auto session = makeSession(request());
  const uvec2 pixel(17, 12);
  const PixelExplanation before = session->explain(pixel, 1);
  session->apply(EditMaterial{"red", {{"baseColor", {0.25, 0.5, 0.75}}, {"roughness", {0.25}}}});
  session->apply(SetTransform{"right", mat4(1.0f)});
  session->apply(SetParameter{"bounces", "2"});
  session->apply(SetLens{.verticalFov = 30.0f});
  EXPECT_EQ(session->restarts(), 4u) << "the explanation is outdated";
  const PixelExplanation after = session->explain(pixel, 1);
  EXPECT_NE(before.events, after.events);
  std::string scene =
      replaced(kScene, "base_color = [0.8, 0.1, 0.1]", "base_color = [0.25, 0.5, 0.75]\nroughness = 0.25");
  scene = replaced(scene, "translate = [3.0, 0.0, 0.0]", "translate = [0.0, 0.0, 0.0]");
  writeFile(folder_ / "b.scene.toml", scene);
  RenderRequest same = request();
  same.scene = folder_ / "b.scene.toml";
  same.assignments = {"bounces=2"};
  same.camera.verticalFov = 30.0f;
  // The automatic environment was chosen before the edits, as in the render.
  PixelExplanation expected = explainRender(same, pixel, 1);
  expected.scene = after.scene;
  expectEqual(after, expected);
}

TEST_F(SessionExplains, FramesAndContinues) {
  RenderRequest frames = request(4);
  frames.scene.clear();
  const auto session = makeSession(frames, "lessons/09_progressive");
  session->step(0);
  frames.frames.accumulated = 4;
  expectEqual(session->explain({20, 12}, 2), explainRender(frames, {20, 12}, 2, "lessons/09_progressive"));
  session->refine();
  RenderJob job(testEngine(), resolve(frames, program::loadProgram("lessons/09_progressive")), observer_);
  EXPECT_EQ(session->result().film->image(0).data, job.run(frames.limits, observer_).film->image(0).data);
}

TEST_F(SessionTest, OrbitsAroundAPickedPoint) {
  const auto session = makeSession(request());
  session->apply(SetOrbitCenter{{3, 1, 0}});
  const float distance = glm::length(session->navigation().eye() - vec3(3, 1, 0));
  EXPECT_NEAR(session->camera().focusDistance, session->navigation().depthOf({3, 1, 0}), 1e-4f);
  EXPECT_LT(glm::length(session->navigation().eye() - vec3(1, 2, 8)), 1e-4f) << "the camera does not move";
  session->apply(Orbit{40, 10});
  EXPECT_NEAR(glm::length(session->navigation().eye() - vec3(3, 1, 0)), distance, 1e-3f);
  EXPECT_THROW(session->apply(SetOrbitCenter{{1, 2, 20}}), UsageError) << "behind the camera";
}

TEST_F(SessionTest, BecomesSharperInSteps) {
  RenderRequest large = request();
  large.size = {256, 256};
  large.launchSeconds = 1e-4;  // more than one launch on any device
  const auto session = makeSession(large);
  std::vector<unsigned> factors;
  for (int i = 0; i < 4; ++i) {
    const std::vector<Event> events = session->step(0);
    const auto* image = find<ImageUpdated>(events);
    ASSERT_NE(image, nullptr);
    EXPECT_EQ(image->size, reducedSize(large.size, image->factor));
    EXPECT_EQ(session->image().width, image->size.x);
    EXPECT_EQ(image->samples, 1u);
    factors.push_back(image->factor);
    now_ += 0.25;
  }
  EXPECT_EQ(factors, (std::vector<unsigned>{8, 4, 2, 1}));
  // Until the refinement has samples, the last preview is shown.
  const std::vector<std::byte> preview = session->image().data;
  EXPECT_EQ(find<ImageUpdated>(session->step(1, [] { return true; })), nullptr);
  EXPECT_EQ(session->image().data, preview);
  session->apply(SetExposure{3});
  EXPECT_NE(find<ImageUpdated>(session->step(0, [] { return true; })), nullptr);
  EXPECT_NE(session->image().data, preview);
  EXPECT_FALSE(session->hasFullSize()) << "the film has no samples, although the image is complete";
  session->apply(Undo{});
  EXPECT_EQ(session->image().data, preview);
  const std::vector<Event> shown = session->step(1000);
  ASSERT_NE(find<ImageUpdated>(shown), nullptr);
  EXPECT_EQ(find<ImageUpdated>(shown)->samples, 1u) << "the changed exposure does not wait for the refinement";
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), reference(large)));
}

TEST_F(SessionTest, AnInterruptedPreviewKeepsTheImage) {
  RenderRequest large = request();
  large.size = {256, 256};
  large.launchSeconds = 1e-6;  // each row is a launch, so that the interruption is seen
  const auto session = makeSession(large);
  unsigned factor = 0;
  while (factor != 2) {
    const std::vector<Event> events = session->step(0);
    ASSERT_NE(find<ImageUpdated>(events), nullptr);
    factor = find<ImageUpdated>(events)->factor;
    now_ += 0.25;
  }
  const std::vector<std::byte> image = session->image().data;
  EXPECT_TRUE(session->step(1, [] { return true; }).empty());
  EXPECT_EQ(session->image().data, image);
  session->apply(SetExposure{3});
  std::vector<Event> events = session->step(1, [] { return true; });
  ASSERT_NE(find<ImageUpdated>(events), nullptr);
  EXPECT_EQ(find<ImageUpdated>(events)->size, uvec2(128));
  EXPECT_EQ(find<ImageUpdated>(events)->factor, 2u);
  EXPECT_NE(session->image().data, image);
  EXPECT_EQ(session->image().width, 128u);
  events = session->step(0);
  ASSERT_NE(find<ImageUpdated>(events), nullptr);
  EXPECT_EQ(find<ImageUpdated>(events)->factor, 1u) << "it does not start over";
}

// The program has two outputs, a red and a green one.
TEST_F(SessionTest, APreviewShowsTheSelectedOutput) {
  writeFile(folder_ / "program.toml",
            "[program]\nray_generation = \"main.rgen\"\n"
            "[[ray]]\nname = \"radiance\"\nmiss = \"<quintet/stages/radiance.rmiss>\"\n[[output]]\nname = \"a\"\nkind "
            "= \"linear\"\n"
            "[[output]]\nname = \"b\"\nkind = \"linear\"\n");
  writeFile(folder_ / "main.rgen",
            "#version 460\n#extension GL_EXT_ray_tracing : require\n#include <quintet/output.glsl>\n"
            "#include <quintet/generated/program.glsl>\n"
            "void main() {\n  const uvec2 pixel = launchPixel();\n  const float n = float(launch.sampleCount);\n"
            "  storeOutput(kOutput_a, pixel, loadOutput(kOutput_a, pixel) + n * vec4(1, 0, 0, 1));\n"
            "  storeOutput(kOutput_b, pixel, loadOutput(kOutput_b, pixel) + n * vec4(0, 1, 0, 1));\n}\n");
  RenderRequest large = request();
  large.size = {256, 256};
  large.launchSeconds = 1e-6;  // each row is a launch
  const auto session = makeSession(large, folder_.path().string());
  for (int i = 0; i < 4; ++i) {
    session->step(0);
    now_ += 0.25;
  }
  EXPECT_EQ(find<ImageUpdated>(session->step(1, [] { return true; })), nullptr) << "the refinement has no samples";
  EXPECT_EQ(session->image().pixel<std::uint8_t>(0, 0)[0], 255);
  session->apply(SelectOutput{"b"});
  const std::vector<Event> events = session->step(0);
  EXPECT_EQ(find<Restarted>(events), nullptr);
  ASSERT_NE(find<ImageUpdated>(events), nullptr);
  EXPECT_EQ(session->image().pixel<std::uint8_t>(0, 0)[0], 0);
  EXPECT_EQ(session->image().pixel<std::uint8_t>(0, 0)[1], 255);
  EXPECT_EQ(session->image().width, find<ImageUpdated>(events)->size.x);
}

TEST_F(SessionTest, UndoRestoresTheFilm) {
  const auto session = makeSession(request());
  session->refine();
  const std::vector<shared::FixedSum> before = sums(*session);
  const std::vector<Command> commands{Orbit{30, 10},
                                      Zoom{2, vec2(3, 4)},
                                      Frame{"right"},
                                      SetLens{.verticalFov = 20.0f},
                                      SetParameter{"bounces", "1"},
                                      EditMaterial{"red", {{"baseColor", {0, 1, 0}}, {"roughness", {0.1}}}},
                                      EditMaterial{"red", {{"emissive", {1, 1, 1}}}},
                                      Move{"left", {0, 1, 0}},
                                      SetSamples{4},
                                      SetSize{{20, 20}}};
  for (const Command& command : commands) {
    session->apply(command);
    session->refine();
    const std::vector<shared::FixedSum> edited = sums(*session);
    EXPECT_FALSE(test::equalSums(edited, before)) << command.index();
    session->apply(Undo{});
    session->refine();
    EXPECT_TRUE(test::equalSums(sums(*session), before)) << command.index();
    session->apply(Redo{});
    session->refine();
    EXPECT_TRUE(test::equalSums(sums(*session), edited)) << command.index();
    session->apply(Undo{});
  }
  EXPECT_THROW(session->apply(Undo{}), UsageError);
}

TEST_F(SessionTest, ADragIsOneStep) {
  const auto session = makeSession(request());
  const CameraRequest before = session->state().camera;
  session->apply(Orbit{10, 0});
  session->apply(Orbit{10, 0});
  session->apply(Undo{});
  EXPECT_EQ(session->state().camera, before);
  // Sliders, too.
  const auto roughness = [](double value) { return EditMaterial{"red", {{"roughness", {value}}}}; };
  session->apply(roughness(0.5));
  session->apply(roughness(0.6));
  session->apply(EditMaterial{"red", {{"metallic", {1}}}});
  session->apply(roughness(0.7));
  session->apply(EndDrag{});
  session->apply(roughness(0.8));
  for (const float expected : {0.7f, 0.6f, 0.6f}) {
    session->apply(Undo{});
    EXPECT_EQ(session->material(0).roughness, expected);
  }
  session->apply(Undo{});
  EXPECT_EQ(session->material(0).roughness, session->scene().materials[0].roughness);
  EXPECT_FALSE(session->canUndo());
  EXPECT_TRUE(session->canRedo());
}

TEST_F(SessionTest, CommandsThatChangeNothingAddNoStep) {
  const auto session = makeSession(request());
  session->refine();
  const std::vector<Command> commands{SelectOutput{"color"},    SetToneMap{},      SetSamples{6}, SetExposure{0},
                                      SetProgram{"pathtracer"}, SetSize{{40, 24}}, SetLens{},     SetEnvironment{}};
  for (const Command& command : commands) {
    session->apply(command);
    EXPECT_FALSE(session->canUndo()) << command.index();
  }
  EXPECT_TRUE(session->step(1).empty()) << "the image stays";
}

TEST_F(SessionTest, EditsToTheSameValueAddNoStep) {
  writeFile(folder_ / "a.scene.toml", litScene());
  const auto session = makeSession(request(1));
  session->apply(SetParameter{"bounces", "3"});
  session->apply(SetParameter{"roulette_start", "2"});
  session->apply(EditLight{"lamp", {{"color", {3, 5, 7}}}});
  session->refine();
  const scene::Light spot = session->light(1).light;
  const std::vector<double> color{3.0 / 7, 5.0 / 7, 1};
  const std::vector<Command> commands{
      SetParameter{"bounces", "3"},
      SetParameter{"bounces", "03"},
      SetParameter{"clamp", "0"},  // the default
      EditMaterial{"red", {{"roughness", {session->material(0).roughness}}, {"metallic", {0}}}},
      EditLight{"lamp", {{"intensity", {20}}, {"color", color}, {"on", {1}}}},
      EditLight{"spot", {{"direction", {0, -1, 0}}, {"outerConeAngle", {glm::degrees(spot.outerConeAngle)}}}},
      SetTransform{"right", session->transform(1)},
      Move{"left", {}}};
  const SessionState before = session->state();
  for (std::size_t i = 0; i < commands.size(); ++i) {
    session->apply(commands[i]);
    EXPECT_TRUE(session->state() == before) << i;
  }
  EXPECT_TRUE(session->step(1).empty()) << "the image stays";
  session->apply(SetParameter{"bounces", "4"});
  EXPECT_EQ(session->state().assignments, (std::vector<std::string>{"bounces=4", "roulette_start=2"}));
  session->apply(Undo{});
  EXPECT_TRUE(session->state() == before);
}

TEST_F(SessionTest, TheSameProgramGetsItsDefaults) {
  writeFile(folder_ / "values.json", "{\"bounces\": 2}");
  RenderRequest few = request();
  few.parameterFile = folder_ / "values.json";
  few.assignments = {"roulette_start=1"};
  const auto session = makeSession(few);
  session->apply(SelectOutput{"normal"});
  session->apply(SetProgram{"pathtracer"});
  EXPECT_EQ(session->state().output, "color");
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), reference(request())));
  session->apply(Undo{});
  EXPECT_EQ(session->state().output, "normal");
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), reference(few)));
}

TEST_F(SessionTest, DisplaySettingsKeepTheSamples) {
  const auto session = makeSession(request());
  session->refine();
  const io::Image before = session->image();
  session->apply(SetExposure{2});
  std::vector<Event> events = session->step(0);
  EXPECT_EQ(find<Restarted>(events), nullptr);
  const auto* image = find<ImageUpdated>(events);
  ASSERT_NE(image, nullptr);
  EXPECT_EQ(image->samples, 6u);
  EXPECT_NE(session->image().data, before.data);
  session->apply(Undo{});
  EXPECT_EQ(session->image().data, before.data);
  session->apply(SetToneMap{render::ToneMap::linear});
  EXPECT_NE(session->image().data, before.data);
}

TEST_F(SessionTest, SelectsOptionalOutputs) {
  const auto session = makeSession(request());
  session->apply(SelectOutput{"normal"});
  session->refine();
  RenderRequest same = request();
  same.outputs = {"normal"};
  RenderJob job(testEngine(), resolve(same, program::loadProgram("pathtracer")), observer_);
  const RenderResult expected = job.run(same.limits, observer_), result = session->result();
  const std::vector<std::string> names = program::outputNames(session->program());
  const auto normal = static_cast<std::size_t>(std::ranges::find(names, "normal") - names.begin());
  EXPECT_TRUE(test::equalSums(result.film->plane(normal).sums, expected.film->plane(normal).sums));
  EXPECT_THAT([&] { session->apply(SelectOutput{"nromal"}); },
              testing::ThrowsMessage<UsageError>(testing::HasSubstr("'normal'")));
}

TEST_F(SessionTest, AFailedCommandChangesNothing) {
  const auto session = makeSession(request());
  session->refine();
  const std::vector<Command> wrong{SetParameter{"bonces", "1"},
                                   SetParameter{"bounces", "many"},
                                   EditMaterial{"red", {{"roughness", {7}}}},
                                   EditMaterial{"blue", {{"roughness", {0}}}},
                                   Move{"middle", {}},
                                   SetTransform{"left", mat4(0.0f)},
                                   SetCamera{{.name = "back"}},
                                   SetFrame{2},
                                   EditLight{"lamp", {{"intensity", {1}}}},
                                   EditMaterial{"default", {{"roughness", {0}}}},
                                   Zoom{0, {}},
                                   Zoom{1e38f, {}},
                                   SetLens{.verticalFov = 180.0f},
                                   SetSamples{0}};
  for (const Command& command : wrong) EXPECT_THROW(session->apply(command), UsageError) << command.index();
  EXPECT_THROW(session->apply(Undo{}), UsageError);
  EXPECT_TRUE(session->step(1).empty());
  EXPECT_TRUE(test::equalSums(sums(*session), reference(request())));
}

TEST_F(SessionTest, AnInterruptedBatchAddsNoSamples) {
  RenderRequest large = request();
  large.size = {256, 256};  // more than one launch
  const auto session = makeSession(large);
  EXPECT_EQ(find<ImageUpdated>(session->refine([] { return true; })), nullptr);
  EXPECT_EQ(session->secondsUntilWork(), 0);
  session->refine();
  EXPECT_TRUE(test::equalSums(sums(*session), reference(large)));
}

TEST_F(SessionTest, RendersFramesOfProgramsThatAccumulate) {
  RenderRequest frames = request(3);
  frames.scene.clear();
  const auto session = makeSession(frames, "lessons/01_first_ray");
  session->apply(SetExposure{0});
  const std::vector<Event> events = session->refine();
  ASSERT_NE(find<ImageUpdated>(events), nullptr);
  EXPECT_EQ(find<ImageUpdated>(events)->samples, 3u);
  EXPECT_TRUE(find<ImageUpdated>(events)->complete);
  frames.frames.accumulated = 3;
  RenderJob job(testEngine(), resolve(frames, program::loadProgram("lessons/01_first_ray")), observer_);
  EXPECT_EQ(session->result().film->image(0).data, job.run(frames.limits, observer_).film->image(0).data);
}

// Its frames depend on the frames before.
TEST_F(SessionTest, FramesStartOverAfterEdits) {
  const auto film = [&](std::uint32_t count, uvec2 size) {
    RenderRequest frames = request(count);
    frames.scene.clear();
    frames.size = size;
    frames.frames.accumulated = count;
    RenderJob job(testEngine(), resolve(frames, program::loadProgram("lessons/09_progressive")), observer_);
    return job.run(frames.limits, observer_).film->image(0).data;
  };
  RenderRequest frames = request(3);
  frames.scene.clear();
  const auto session = makeSession(frames, "lessons/09_progressive");
  session->step(0);
  now_ += 1;
  session->step(1000);
  const auto shown = [&] { return session->result().film->image(0).data; };
  EXPECT_EQ(shown(), film(3, {40, 24}));
  session->apply(SetSize{{30, 20}});
  session->step(0);  // a preview
  session->refine();
  EXPECT_EQ(shown(), film(3, {30, 20}));
  session->apply(SetSamples{5});
  session->refine();
  EXPECT_EQ(shown(), film(5, {30, 20}));
  session->apply(Undo{});
  session->apply(Undo{});
  session->refine();
  EXPECT_EQ(shown(), film(3, {40, 24}));
}

TEST_F(SessionTest, RewindStartsWithTheFirstFrame) {
  RenderRequest frames = request(3);
  frames.scene.clear();
  const auto session = makeSession(frames, "lessons/09_progressive");
  session->refine();
  const std::vector<std::byte> complete = session->result().film->image(0).data;
  const std::uint64_t restarts = session->restarts();
  session->apply(Rewind{});
  EXPECT_EQ(session->restarts(), restarts + 1);
  EXPECT_FALSE(session->canUndo());
  EXPECT_FALSE(session->hasFullSize()) << "the frames are discarded";
  EXPECT_EQ(session->secondsUntilWork(), 0);
  const std::vector<Event> events = session->step(0);
  ASSERT_NE(find<ImageUpdated>(events), nullptr);
  EXPECT_EQ(find<ImageUpdated>(events)->samples, 1u);
  EXPECT_NE(find<Restarted>(events), nullptr);
  session->refine();
  EXPECT_EQ(session->result().film->image(0).data, complete);
}

// A program on disk that writes one color.
class SessionReload : public SessionTest {
 protected:
  void save(const std::string& color) {
    writeFile(folder_ / "p.rt.glsl",
              "void main() { /**** RAY GENERATION SHADER ****/\n  gsnSetPixel(vec4(" + color + "));\n}\n");
  }
  std::uint8_t red(const Session& session) { return session.image().pixel<std::uint8_t>(0, 0)[0]; }
};

// The program compiles only for scenes without clear coat.
TEST_F(SessionReload, ReportsAFailureUntilItIsCorrected) {
  writeFile(folder_ / "p.rt.glsl",
            "#ifndef QUINTET_NO_CLEARCOAT\n#error no clear coat\n#endif\n"
            "void main() { /**** RAY GENERATION SHADER ****/\n  gsnSetPixel(vec4(1.0, 0.0, 0.0, 1.0));\n}\n");
  const auto session = makeSession(request(1), (folder_ / "p.rt.glsl").string());
  EXPECT_EQ(find<Failed>(session->refine()), nullptr);
  session->apply(EditMaterial{"red", {{"clearcoat", {1}}}});
  EXPECT_NE(find<Failed>(session->step(0)), nullptr);
  EXPECT_TRUE(session->step(0).empty());
  EXPECT_EQ(session->secondsUntilWork(), std::numeric_limits<double>::infinity());
  EXPECT_NE(find<Failed>(session->refine()), nullptr);
  session->apply(Undo{});
  const std::vector<Event> events = session->refine();
  EXPECT_EQ(find<Failed>(events), nullptr);
  ASSERT_NE(find<ImageUpdated>(events), nullptr);
  EXPECT_TRUE(find<ImageUpdated>(events)->complete);
  EXPECT_EQ(red(*session), 255);
}

TEST_F(SessionReload, UndoSkipsWhatNoLongerExists) {
  save("1.0, 0.0, 0.0, 1.0");
  const auto session = makeSession(request(1), "normals");
  session->apply(SetExposure{1});
  session->apply(SetProgram{(folder_ / "p.rt.glsl").string()});
  session->apply(SetProgram{"ao"});
  std::filesystem::remove(folder_ / "p.rt.glsl");
  EXPECT_THROW(session->apply(Undo{}), Error);
  EXPECT_EQ(session->state().program, "ao");
  session->apply(Undo{});
  EXPECT_EQ(session->state().program, "normals");
  EXPECT_EQ(session->state().exposure, 1.0);
  session->apply(Redo{});
  EXPECT_EQ(session->state().program, "ao");
}

TEST_F(SessionReload, UndoWaitsForProgramsWithErrors) {
  save("1.0, 0.0, 0.0, 1.0");
  const auto session = makeSession(request(1), (folder_ / "p.rt.glsl").string());
  session->apply(SetProgram{"normals"});
  save("nothing");
  EXPECT_THROW(session->apply(Undo{}), ProgramError);
  EXPECT_EQ(session->state().program, "normals");
  save("0.0, 1.0, 0.0, 1.0");
  session->apply(Undo{});
  session->refine();
  EXPECT_EQ(session->image().pixel<std::uint8_t>(0, 0)[1], 255);
  EXPECT_FALSE(session->canUndo());
}

// The removed step makes the next undo change two things, of which the second one fails.
TEST_F(SessionReload, AFailedUndoChangesNothing) {
  save("1.0, 0.0, 0.0, 1.0");
  for (const char* name : {"a.hdr", "b.hdr"})
    io::writeImage(folder_ / name, io::makeImage(4, 2, 3, io::PixelType::f32, io::ColorEncoding::linear));
  const auto session = makeSession(request(1), "normals");
  session->apply(SetEnvironment{.source = (folder_ / "a.hdr").string()});
  session->apply(SetProgram{(folder_ / "p.rt.glsl").string()});
  session->apply(SetEnvironment{.source = (folder_ / "b.hdr").string()});
  session->apply(SetProgram{"ao"});
  session->apply(SetEnvironment{.source = "none"});
  session->refine();
  const auto film = sums(*session);
  const SessionState before = session->state();
  std::filesystem::remove(folder_ / "a.hdr");
  std::filesystem::remove(folder_ / "b.hdr");
  std::filesystem::remove(folder_ / "p.rt.glsl");
  for (int i = 0; i < 4; ++i) {
    EXPECT_THROW(session->apply(Undo{}), Error) << i;
    EXPECT_TRUE(session->state() == before) << i;
    session->refine();
    EXPECT_TRUE(test::equalSums(sums(*session), film)) << i;
  }
  session->apply(Undo{});
  EXPECT_EQ(session->state().program, "normals");
}

TEST_F(SessionReload, PrintsTheChosenPixels) {
  save("1.0, 0.0, 0.0, 1.0)); debugPrintfEXT(\"launch %d\", (int(gl_LaunchIDEXT.x)");
  const auto session = makeSession(request(3), (folder_ / "p.rt.glsl").string());
  EXPECT_TRUE(session->callsPrint());
  EXPECT_TRUE(printedLines(session->refine()).empty()) << "no pixel was chosen";
  session->apply(SetPrint{PrintRequest{.pixels = {5, 6, 2, 1}}});
  std::vector<Event> events = session->step(0.01);
  EXPECT_NE(find<Restarted>(events), nullptr);
  EXPECT_TRUE(printedLines(events).empty()) << "a preview prints nothing";
  events = session->refine();
  std::vector<std::string> texts;
  for (const PrintedLine& line : printedLines(events)) texts.push_back(line.text);
  EXPECT_THAT(texts, testing::ElementsAre("launch 5", "launch 6", "launch 5", "launch 6", "launch 5", "launch 6"));
  EXPECT_EQ(printedLines(events).front().pixel, uvec2(5, 6));
  session->apply(SetPrint{PrintRequest{.all = true, .limit = 4}});
  events = session->refine();
  EXPECT_EQ(printedLines(events).size(), 4u);
  std::uint64_t omitted = 0;
  for (const Event& event : events)
    if (const auto* printed = std::get_if<LinesPrinted>(&event)) omitted += printed->printed.omitted;
  EXPECT_EQ(omitted, 3u * 40 * 24 - 4);
  session->apply(SetSize{{60, 30}});
  EXPECT_EQ(printedLines(session->refine()).size(), 4u) << "each change counts from 0 again";
  EXPECT_THROW(session->apply(SetPrint{PrintRequest{.pixels = {60, 0, 1, 1}}}), UsageError);
  session->apply(SetPrint{});
  EXPECT_TRUE(printedLines(session->refine()).empty());
}

TEST_F(SessionReload, KeepsTheLastGoodProgram) {
  save("1.0, 0.0, 0.0, 1.0");
  const auto session = makeSession(request(1), (folder_ / "p.rt.glsl").string());
  session->refine();
  EXPECT_EQ(red(*session), 255);
  save("1.0, 0.0, 0.0, nothing");
  std::vector<Event> events = session->refine();
  const auto* found = find<DiagnosticsFound>(events);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->diagnostics.front().line, 2);
  EXPECT_EQ(find<Restarted>(events), nullptr);
  EXPECT_EQ(red(*session), 255);
  save("0.0, 1.0, 0.0, 1.0");
  events = session->refine();
  ASSERT_NE(find<ProgramReloaded>(events), nullptr);
  EXPECT_EQ(find<ProgramReloaded>(events)->files, "p.rt.glsl");
  EXPECT_EQ(red(*session), 0);
}

// A user removes a parameter after its value was changed: the value goes, not the edit.
TEST_F(SessionReload, LeavesOutValuesThatAVersionDoesNotAccept) {
  const auto saveWith = [&](const std::string& declarations, const std::string& color) {
    writeFile(
        folder_ / "p.rt.glsl",
        declarations + "void main() { /**** RAY GENERATION SHADER ****/\n  gsnSetPixel(vec4(" + color + "));\n}\n");
  };
  const std::string green = "uniform float green;  // defaultval=\"0\"\n";
  saveWith(green + "uniform float shade;  // defaultval=\"0\"\n", "shade, green, 0.0, 1.0");
  const auto session = makeSession(request(1), (folder_ / "p.rt.glsl").string());
  session->apply(SetParameter{"shade", "1"});
  session->apply(SetParameter{"green", "1"});
  session->refine();
  EXPECT_EQ(red(*session), 255);
  saveWith(green, "0.0, green, 1.0, 1.0");
  const std::vector<Event> events = session->refine();
  ASSERT_NE(find<ProgramReloaded>(events), nullptr);
  ASSERT_NE(find<Warning>(events), nullptr);
  const std::string text = find<Warning>(events)->text;
  EXPECT_TRUE(text.starts_with("'shade=1' no longer applies: unknown parameter 'shade'")) << text;
  EXPECT_EQ(session->image().pixel<std::uint8_t>(0, 0)[0], 0);
  EXPECT_EQ(session->image().pixel<std::uint8_t>(0, 0)[1], 255) << "the other value stays";
  EXPECT_EQ(session->state().assignments, std::vector<std::string>{"green=1"});
}

}  // namespace
}  // namespace quintet::job::interactive
