// SPDX-License-Identifier: Apache-2.0
// A request that cannot succeed fails before a device is opened; a good one is complete.
#include "job/resolve.h"

#include <gmock/gmock.h>

#include <limits>

#include "base/error.h"
#include "base/file.h"
#include "program/load.h"
#include "temp_folder.h"

namespace quintet::job {
namespace {

using testing::HasSubstr;

program::Program pathTracer() { return program::loadProgram("pathtracer"); }
program::Program lecture() { return program::loadProgram("lessons/01_first_ray"); }

RenderRequest makeRequest() {
  RenderRequest request;
  request.limits.samples = 16;
  return request;
}

TEST(Resolve, CompletesTheRequest) {
  RenderRequest request = makeRequest();
  request.assignments = {"bounces=3"};
  const ResolvedJob job = resolve(request, pathTracer());
  EXPECT_EQ(job.program.name, "pathtracer");
  EXPECT_THAT(job.parameters.describe(), HasSubstr("bounces=3"));
  EXPECT_EQ(job.scene.name, "default scene");
  EXPECT_FALSE(job.accumulatesFrames());
  EXPECT_TRUE(resolve(makeRequest(), lecture()).accumulatesFrames());
}

TEST(Resolve, AssignmentsFollowTheParameterFile) {
  const quintet::test::TempFolder folder;
  writeFile(folder / "values.json", R"({"bounces": 5, "clamp": 2})");
  RenderRequest request = makeRequest();
  request.parameterFile = folder / "values.json";
  request.assignments = {"bounces=3"};
  const std::string parameters = resolve(request, pathTracer()).parameters.describe();
  EXPECT_THAT(parameters, HasSubstr("bounces=3"));
  EXPECT_THAT(parameters, HasSubstr("clamp=2"));
}

TEST(Resolve, RejectsUnsupportedLimits) {
  const auto rejects = [](const program::Program& program, const auto& change) {
    RenderRequest request = makeRequest();
    change(request);
    try {
      resolve(request, program);
    } catch (const UsageError&) {
      return true;
    }
    return false;
  };
  const program::Program normals = program::loadProgram("normals");
  EXPECT_FALSE(rejects(pathTracer(), [](RenderRequest& r) { r.limits.adaptive = true; }));
  EXPECT_TRUE(rejects(normals, [](RenderRequest& r) { r.limits.adaptive = true; }));
  EXPECT_FALSE(rejects(pathTracer(), [](RenderRequest& r) { r.limits.error = 0.1; }));
  EXPECT_TRUE(rejects(lecture(), [](RenderRequest& r) { r.limits.error = 0.1; }));
  EXPECT_TRUE(rejects(lecture(), [](RenderRequest& r) { r.film = "a.qfilm"; }));
  EXPECT_TRUE(rejects(lecture(), [](RenderRequest& r) { r.checkpoint.file = "a.qfilm"; }));
  EXPECT_TRUE(rejects(pathTracer(), [](RenderRequest& r) { r.assignments = {"bouncs=3"}; }));
}

TEST(Resolve, Batches) {
  const auto errorFor = [](BatchRange batches, const auto& change) -> std::string {
    RenderRequest request = makeRequest();  // batches 0–3
    request.batches = batches;
    change(request);
    try {
      resolve(request, pathTracer());
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(errorFor({0, 3}, [](RenderRequest&) {}), "");
  EXPECT_THAT(errorFor({2, 4}, [](RenderRequest&) {}), HasSubstr("last batch of 16 samples is 3"));
  EXPECT_NE(errorFor({0, 1}, [](RenderRequest& r) { r.limits.seconds = 1; }), "");
  EXPECT_NE(errorFor({0, 1}, [](RenderRequest& r) { r.limits.adaptive = true; }), "");
  EXPECT_NE(errorFor({0, 1}, [](RenderRequest& r) { r.limits.samples.reset(); }), "");
}

TEST(Resolve, ChecksTimesAndFrames) {
  const auto problem = [](const program::Program& program, const auto& change) -> std::string {
    RenderRequest request = makeRequest();
    change(request);
    try {
      resolve(request, program);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  const program::Program program = pathTracer();
  EXPECT_EQ(problem(program, [](RenderRequest& r) { r.frames.seconds = 0.5; }), "");
  EXPECT_THAT(problem(program, [](RenderRequest& r) { r.frames.seconds = -0.5; }), HasSubstr("at least 0 seconds"));
  EXPECT_THAT(problem(program, [](RenderRequest& r) { r.frames.seconds = 1, r.frames.count = 3; }),
              HasSubstr("exclude each other"));
  EXPECT_THAT(problem(lecture(), [](RenderRequest& r) { r.frames.seconds = 1; }),
              HasSubstr("counts its frames itself"));
  EXPECT_THAT(problem(program, [](RenderRequest& r) { r.framesPerSecond = 0; }), HasSubstr("frames per second"));
  const auto several = [](RenderRequest& r) { r.frames.count = 3, r.frames.every = true; };
  EXPECT_EQ(problem(program, several), "");
  EXPECT_THAT(problem(program,
                      [&](RenderRequest& r) {
                        several(r), r.batches = BatchRange{0, 1};
                      }),
              HasSubstr("a film holds one frame"));
  EXPECT_THAT(problem(program, [&](RenderRequest& r) { several(r), r.checkpoint.keep = true; }),
              HasSubstr("share one checkpoint"));
}

TEST(Resolve, ChecksTheShutter) {
  const auto problem = [](double open, double close, const program::Program& program = pathTracer()) -> std::string {
    RenderRequest request = makeRequest();
    request.shutter = ShutterRequest{open, close};
    try {
      resolve(request, program);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(problem(0, 0.5), "");
  EXPECT_EQ(problem(-0.25, 0.25), "");
  EXPECT_EQ(problem(0.5, 0.5), "") << "no blur";
  EXPECT_THAT(problem(0.5, 0.25), HasSubstr("shutter 0.5,0.25: it closes before it opens"));
  EXPECT_THAT(problem(0, 1001), HasSubstr("-1000 to 1000 frames"));
  EXPECT_THAT(problem(std::numeric_limits<double>::quiet_NaN(), 0), HasSubstr("-1000 to 1000 frames"));
  EXPECT_THAT(problem(0, std::numeric_limits<double>::infinity()), HasSubstr("-1000 to 1000 frames"));
  EXPECT_THAT(problem(0, 0.5, lecture()), HasSubstr("averages its frames itself"));
}

// The rest pose is loaded unless the request needs an animation.
TEST(Resolve, LoadsAnAnimationOnRequest) {
  const auto animation = [](const auto& change, bool accumulates = false) {
    RenderRequest request = makeRequest();
    change(request);
    return loadOptions(request, accumulates).animation;
  };
  const auto nothing = [](RenderRequest&) {};
  const auto frame = [](RenderRequest& r) { r.frames.first = 0, r.frames.count = 1; };
  EXPECT_EQ(animation(nothing), std::nullopt);
  EXPECT_EQ(animation(frame), "");
  EXPECT_EQ(animation(frame, true), std::nullopt) << "the program counts its frames itself";
  EXPECT_EQ(animation([](RenderRequest& r) { r.frames.seconds = 0; }), "");
  EXPECT_EQ(animation([](RenderRequest& r) { r.shutter = ShutterRequest{0, 0.5}; }), "");
  EXPECT_EQ(animation([](RenderRequest& r) { r.editable = true; }), "");
  EXPECT_EQ(animation([](RenderRequest& r) { r.animation = "Walk"; }), "Walk");
  EXPECT_EQ(animation([](RenderRequest& r) { r.animation = "Walk"; }, true), "Walk");
  EXPECT_EQ(animation([](RenderRequest& r) { r.animation = "none", r.editable = true; }), std::nullopt);
}

// A frame of a program that accumulates depends on the frames before it.
TEST(Resolve, PartsOfAnAnimation) {
  RenderRequest request = makeRequest();
  request.frames.count = 4;
  EXPECT_NO_THROW(resolve(request, lecture()));
  for (const std::uint32_t first : {0u, 4u}) {
    request.frames.first = first;
    EXPECT_NO_THROW(resolve(request, pathTracer()));
    EXPECT_THROW(resolve(request, lecture()), UsageError);
  }
  EXPECT_EQ(request.frames.firstFrame(), 4u);
  EXPECT_EQ(request.frames.lastFrame(), 7u);
}

TEST(Resolve, ChecksFiles) {
  const quintet::test::TempFolder folder;
  RenderRequest request = makeRequest();
  request.film = folder / "no/such/folder/a.qfilm";
  EXPECT_THROW(resolve(request, pathTracer()), FileError);
  request.film = folder / "a.qfilm";
  request.checkpoint.file = folder / "x/../a.qfilm";
  EXPECT_THROW(resolve(request, pathTracer()), UsageError) << "the checkpoint is the output";
  request.checkpoint.file = folder / "a.png";
  EXPECT_THROW(resolve(request, pathTracer()), UsageError) << "the extension";
  request.checkpoint.file = folder / "b.qfilm";
  EXPECT_NO_THROW(resolve(request, pathTracer()));
  request.scene = folder / "absent.glb";
  EXPECT_THROW(resolve(request, pathTracer()), FileError);
  EXPECT_EQ(folder.entryCount(), 0u);
}

TEST(SceneSource, TheFirstThatExists) {
  const quintet::test::TempFolder folder;
  writeFile(folder / "a.scene.toml", "");
  EXPECT_EQ(chooseSceneSource(folder / "a.scene.toml", lecture()).file, folder / "a.scene.toml");
  const SceneSource own = chooseSceneSource({}, lecture());
  EXPECT_TRUE(own.file.empty());
  EXPECT_FALSE(own.text.empty());
  EXPECT_GT(loadScene(own).instances.size(), 0u);
  const SceneSource builtIn = chooseSceneSource({}, pathTracer());
  EXPECT_TRUE(builtIn.text.empty());
  EXPECT_GT(loadScene(builtIn).instances.size(), 0u);
}

TEST(SceneSource, ASceneInMemoryIsCopied) {
  auto scene = std::make_shared<scene::Scene>();
  scene->name = "mine";
  scene->cameras.resize(1);
  RenderRequest request = makeRequest();
  request.loadedScene = scene;
  const ResolvedJob job = resolve(request, pathTracer());
  EXPECT_EQ(job.scene.name, "mine");
  EXPECT_EQ(loadScene(job.scene).cameras.size(), 1u);
}

TEST(IsProgramSource, ShadersAndDescriptions) {
  for (const char* name : {"program.toml", "a.rgen", "b.rchit", "c.glsl", "d.h"})
    EXPECT_TRUE(isProgramSource(name)) << name;
  for (const char* name : {"out.png", ".swap.glsl", "a.qfilm", "a.exr", "a"})
    EXPECT_FALSE(isProgramSource(name)) << name;
}

}  // namespace
}  // namespace quintet::job
