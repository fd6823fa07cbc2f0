// SPDX-License-Identifier: Apache-2.0
// Render jobs as a front end uses them: runs that continue, stop, and resume give the film of one uninterrupted run.
#include "job/render_job.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "base/error.h"
#include "base/file.h"
#include "job/film_store.h"
#include "job/films.h"
#include "job/test_engine.h"
#include "job/watch.h"
#include "program/load.h"
#include "temp_folder.h"

namespace quintet::job {
namespace {

struct TestObserver : Observer {
  void progress(const Progress& state) override { states.push_back(state); }
  void batch(const BatchReport& report) override {
    batches.push_back(report);
    if (batches.size() >= finishAfter) request = StopRequest::finish;
  }
  void frame(const RenderResult& result) override { frames.push_back(result.provenance.frame.value_or(1000)); }
  bool wantsPreviews() const override { return true; }
  void preview(const RenderResult& result) override { previews.push_back(result.provenance.samples); }
  void diagnostics(const std::vector<Diagnostic>& found) override {
    reported.insert(reported.end(), found.begin(), found.end());
  }
  StopRequest stopRequested() override { return request; }

  std::size_t finishAfter = 1000;
  StopRequest request = StopRequest::none;
  std::vector<Progress> states;
  std::vector<BatchReport> batches;
  std::vector<std::uint64_t> frames, previews;
  std::vector<Diagnostic> reported;
};

RenderRequest makeRequest(std::uint64_t samples) {
  RenderRequest request;
  request.size = {24, 16};
  request.limits.samples = samples;
  request.seed = 7;
  return request;
}

class RenderJobTest : public testing::Test {
 protected:
  std::unique_ptr<RenderJob> makeJob(const RenderRequest& request, const char* program = "normals") {
    return std::make_unique<RenderJob>(testEngine(), resolve(request, program::loadProgram(program)), observer_);
  }
  // The sums of a render without interruption.
  std::vector<shared::FixedSum> reference(std::uint64_t samples) {
    TestObserver observer;
    const RenderRequest request = makeRequest(samples);
    RenderJob job(testEngine(), resolve(request, program::loadProgram("normals")), observer);
    return job.run(request.limits, observer).film->plane(0).sums;
  }

  TestObserver observer_;
};

TEST_F(RenderJobTest, ReportsTheRender) {
  const RenderRequest request = makeRequest(8);
  const auto job = makeJob(request);
  const RenderResult result = job->run(request.limits, observer_);
  EXPECT_EQ(result.provenance.samples, 8u);
  EXPECT_EQ(result.provenance.size, uvec2(24, 16));
  EXPECT_EQ(result.provenance.region, (render::Region{0, 0, 24, 16}));
  EXPECT_EQ(result.provenance.program, "normals");
  EXPECT_GE(result.provenance.rays, 8u * 24 * 16);
  EXPECT_FALSE(result.interrupted);
  EXPECT_EQ(result.film->counts().ranges, (std::vector<render::SampleRange>{{0, 8}}));
  ASSERT_EQ(observer_.batches.size(), 2u);
  EXPECT_EQ(observer_.batches[0].samples, 4u);
  EXPECT_EQ(observer_.batches[1].samples, 8u);
  EXPECT_THAT(observer_.previews, testing::ElementsAre(4u)) << "of the first batch";
  ASSERT_FALSE(observer_.states.empty());
  for (const Progress& state : observer_.states) EXPECT_LE(state.fraction(), 1.0);
}

TEST_F(RenderJobTest, ASecondRunContinues) {
  const auto job = makeJob(makeRequest(12));
  RenderLimits limits;
  limits.samples = 4;
  EXPECT_EQ(job->run(limits, observer_).provenance.samples, 4u);
  limits.samples = 12;
  const RenderResult result = job->run(limits, observer_);
  EXPECT_EQ(result.provenance.samples, 12u);
  EXPECT_TRUE(test::equalSums(result.film->plane(0).sums, reference(12)));
}

TEST_F(RenderJobTest, FinishCompletesTheBatch) {
  const RenderRequest request = makeRequest(16);
  const auto job = makeJob(request);
  observer_.finishAfter = 1;
  const RenderResult stopped = job->run(request.limits, observer_);
  EXPECT_TRUE(stopped.interrupted);
  EXPECT_TRUE(stopped.provenance.interrupted);
  EXPECT_EQ(stopped.provenance.samples, 4u);
  observer_.finishAfter = 1000;
  observer_.request = StopRequest::none;
  const RenderResult complete = job->run(request.limits, observer_);
  EXPECT_FALSE(complete.interrupted);
  EXPECT_TRUE(test::equalSums(complete.film->plane(0).sums, reference(16)));
}

TEST_F(RenderJobTest, FinishAfterTheLastBatchIsNoInterruption) {
  const RenderRequest request = makeRequest(4);
  observer_.finishAfter = 1;
  EXPECT_FALSE(makeJob(request)->run(request.limits, observer_).interrupted);
}

TEST_F(RenderJobTest, AbandonReturnsAtOnce) {
  const RenderRequest request = makeRequest(16);
  const auto job = makeJob(request);
  observer_.request = StopRequest::abandon;
  EXPECT_TRUE(job->run(request.limits, observer_).abandoned);
  EXPECT_TRUE(observer_.batches.empty());
}

TEST_F(RenderJobTest, ResumesFromACheckpoint) {
  const quintet::test::TempFolder folder;
  RenderRequest request = makeRequest(12);
  request.checkpoint = {.file = folder / "a.qfilm", .seconds = 0, .resume = true};
  {
    observer_.finishAfter = 1;
    const auto job = makeJob(request);
    const RenderResult stopped = job->run(request.limits, observer_);
    EXPECT_TRUE(stopped.interrupted);
    EXPECT_EQ(observer_.batches[0].checkpointSamples, 4u);
    job->outputsWritten(stopped, observer_);
    EXPECT_TRUE(std::filesystem::exists(request.checkpoint.file)) << "the render is incomplete";
  }
  observer_.finishAfter = 1000;
  observer_.request = StopRequest::none;
  {
    const auto job = makeJob(request);
    const RenderResult complete = job->run(request.limits, observer_);
    EXPECT_TRUE(test::equalSums(complete.film->plane(0).sums, reference(12)));
    job->outputsWritten(complete, observer_);
    EXPECT_FALSE(std::filesystem::exists(request.checkpoint.file));
  }
  EXPECT_EQ(folder.entryCount(), 0u) << "the lock is released with the job";
}

TEST_F(RenderJobTest, APartHasItsBatches) {
  RenderRequest request = makeRequest(16);
  request.batches = BatchRange{1, 2};
  const auto job = makeJob(request);
  const RenderResult part = job->run(request.limits, observer_);
  EXPECT_EQ(part.film->counts().ranges, (std::vector<render::SampleRange>{{4, 12}}));
  EXPECT_EQ(part.provenance.plannedSamples, 16u);
}

TEST_F(RenderJobTest, AFilmIsNotOverwrittenByFewerSamples) {
  const quintet::test::TempFolder folder;
  RenderRequest request = makeRequest(8);
  request.film = folder / "a.qfilm";
  render::writeFilm(request.film, filmFileOf(makeJob(request)->run(request.limits, observer_)));
  request.limits.samples = 8;
  request.batches = BatchRange{0, 0};
  EXPECT_THROW(makeJob(request)->run(request.limits, observer_), FileError);
  request.overwriteFilm = true;
  EXPECT_NO_THROW(makeJob(request)->run(request.limits, observer_));
}

TEST_F(RenderJobTest, FramesContinueAcrossRuns) {
  RenderRequest request = makeRequest(0);
  request.limits.samples.reset();
  const auto job = makeJob(request, "lessons/01_first_ray");
  RenderLimits limits;
  limits.samples = 2;
  EXPECT_EQ(job->run(limits, observer_).provenance.frame, 1u);
  limits.samples = 3;
  const RenderResult result = job->run(limits, observer_);
  EXPECT_EQ(result.provenance.frame, 2u);
  EXPECT_EQ(job->renderer().statistics().samples, 3u);
}

TEST_F(RenderJobTest, EveryFrameIsReported) {
  RenderRequest request = makeRequest(1);
  request.frames = {.count = 3, .every = true};
  makeJob(request, "lessons/01_first_ray")->run(request.limits, observer_);
  EXPECT_THAT(observer_.frames, testing::ElementsAre(0u, 1u, 2u));
}

// A scene whose quad moves, so that no two frames are equal. The light moves with it.
class AnimatedJobTest : public RenderJobTest {
 protected:
  AnimatedJobTest() {
    writeFile(folder_ / "a.scene.toml",
              "[[material]]\nname = \"lamp\"\nemissive = [2.0, 1.0, 0.5]\n"
              "[[mesh]]\nname = \"quad\"\nshape = \"quad\"\nmaterial = \"lamp\"\n"
              "[[instance]]\nof = \"quad\"\n"
              "keyframes = [{ frame = 0 }, { frame = 8, translate = [1.0, 2.0, 0.5] }]\n"
              "[[camera]]\nlook_from = [0, 1, 5]\nlook_at = [0, 0, 0]\n");
  }
  struct Recorder : TestObserver {
    void frame(const RenderResult& result) override {
      TestObserver::frame(result);
      sums.push_back(result.film->plane(0).sums);
    }
    void warning(const std::string& text) override { warnings.push_back(text); }
    std::vector<std::vector<shared::FixedSum>> sums;
    std::vector<std::string> warnings;
  };
  RenderResult render(const FrameRequest& frames, Recorder& recorder, std::optional<double> error = {}) {
    RenderRequest request = makeRequest(4);
    request.scene = folder_ / "a.scene.toml";
    request.frames = frames;
    request.limits.error = error;
    return RenderJob(testEngine(), resolve(request, program::loadProgram("pathtracer")), recorder)
        .run(request.limits, recorder);
  }
  const quintet::test::TempFolder folder_;
};

TEST_F(AnimatedJobTest, PartsHaveTheFramesOfTheWhole) {
  Recorder whole, part, single;
  render({.count = 5, .every = true}, whole);
  render({.count = 2, .first = 3, .every = true}, part);
  render({.count = 1, .first = 2}, single);
  EXPECT_THAT(whole.frames, testing::ElementsAre(0u, 1u, 2u, 3u, 4u));
  EXPECT_THAT(part.frames, testing::ElementsAre(3u, 4u));
  EXPECT_TRUE(single.frames.empty()) << "the result is the frame";
  ASSERT_EQ(part.sums.size(), 2u);
  EXPECT_TRUE(test::equalSums(part.sums[0], whole.sums[3]));
  EXPECT_TRUE(test::equalSums(part.sums[1], whole.sums[4]));
  EXPECT_FALSE(test::equalSums(whole.sums[3], whole.sums[4]));
  const RenderResult last = render({.count = 1, .first = 4}, single);
  EXPECT_EQ(last.provenance.frame, 4u);
}

TEST_F(AnimatedJobTest, ReportsFramesThatMissTheTarget) {
  Recorder recorder;
  const RenderResult result = render({.count = 2, .every = true}, recorder, 1e-6);
  EXPECT_TRUE(result.targetMissed);
  EXPECT_TRUE(result.earlierTargetMissed);
  ASSERT_EQ(recorder.warnings.size(), 1u);
  EXPECT_THAT(recorder.warnings[0], testing::HasSubstr("frame 0: the target error"));
}

// A solid that moves around the camera within a second, one that becomes a medium, and an environment that gets brighter.
class MediumJobTest : public RenderJobTest {
 protected:
  MediumJobTest() {
    const std::string glass =
        "metallic = 0\nroughness = 0\nior = 1\ntransmission = 1\nthickness = 1\n"
        "attenuation_color = [0.5, 0.25, 1]\nattenuation_distance = 2\n";
    const std::string sky = "[environment]\ncolor = [1, 1, 1]\n";
    write("moves",
          "[[material]]\nname = \"glass\"\n" + glass +
              cube("keyframes = [{ frame = 0, translate = [9, 0, 0] }, { frame = 24, translate = [0, 0, 0] }]\n",
                   "material = \"glass\"\n") +
              sky);
    write("becomes", "[[material]]\nname = \"glass\"\n" + glass +
                         "keyframes = [{ frame = 0, transmission = 0 }, { frame = 24, transmission = 1 }]\n" +
                         cube("", "material = \"glass\"\n") + sky);
    write("sky", cube("translate = [9, 0, 0]\n") + sky +
                     "keyframes = [{ frame = 0, intensity = 0 }, { frame = 24, intensity = 3 }]\n");
  }
  void write(const std::string& name, const std::string& text) {
    writeFile(folder_ / (name + ".scene.toml"),
              text + "[[camera]]\nlook_from = [0, 0, 0]\nlook_at = [0, 0, -1]\nfov = 1\n");
  }
  static std::string cube(const std::string& instance, const std::string& mesh = "") {
    return "[[mesh]]\nname = \"box\"\nshape = \"cube\"\n" + mesh + "[[instance]]\nof = \"box\"\n" + instance;
  }
  RenderRequest requestFor(const std::string& scene) {
    RenderRequest request = makeRequest(4);
    request.scene = folder_ / (scene + ".scene.toml");
    return request;
  }
  static std::vector<float> pixelOf(const RenderResult& result) {
    const io::Image image = result.film->image(0);
    const auto pixel = image.pixel<float>(3, 5);
    return {pixel[0], pixel[1], pixel[2]};
  }
  const quintet::test::TempFolder folder_;
};

TEST_F(MediumJobTest, EachWayToAFrameShowsItsMediumAndEnvironment) {
  const float meter = std::sqrt(0.5f);
  const std::map<std::string, std::vector<float>> expected{
      {"moves", {meter, 0.5f, 1}}, {"becomes", {meter, 0.5f, 1}}, {"sky", {3, 3, 3}}};
  for (const auto& [scene, color] : expected) {
    SCOPED_TRACE(scene);
    const auto isExpected = testing::Pointwise(testing::FloatNear(2e-3f), color);
    RenderRequest request = requestFor(scene);
    const auto job = makeJob(request, "pathtracer");
    EXPECT_THAT(pixelOf(job->run(request.limits, observer_)), testing::Not(isExpected)) << "at the start";
    job->setFrame(24);
    EXPECT_THAT(pixelOf(job->run(request.limits, observer_)), isExpected) << "after setFrame()";
    job->setFrame(0);
    EXPECT_THAT(pixelOf(job->run(request.limits, observer_)), testing::Not(isExpected)) << "back at the start";
    FrameRequest frames;
    frames.seconds = 1.0;
    for (const FrameRequest& way :
         {frames, FrameRequest{.count = 1, .first = 24}, FrameRequest{.count = 2, .first = 23, .every = true}}) {
      request.frames = way;
      EXPECT_THAT(pixelOf(makeJob(request, "pathtracer")->run(request.limits, observer_)), isExpected)
          << way.seconds.has_value() << way.every;
    }
  }
}

TEST_F(RenderJobTest, AStillSceneHasOneFrame) {
  RenderRequest request = makeRequest(4);
  for (const FrameRequest& frames : {FrameRequest{.count = 4}, FrameRequest{.count = 1, .first = 2}}) {
    request.frames = frames;
    try {
      makeJob(request)->run(request.limits, observer_);
      FAIL();
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("neither keyframes nor an animation"));
    }
  }
  request.frames = {.count = 1, .first = 0};
  EXPECT_NO_THROW(makeJob(request)->run(request.limits, observer_));
}

// A front end that watches files loads the scene once, even if the program is broken at first.
TEST_F(RenderJobTest, ScenesOutliveJobs) {
  const quintet::test::TempFolder folder;
  writeFile(folder / "broken.rt.glsl",
            "struct RayPayloadType { vec3 color; };\n"
            "void main() { /**** RAY GENERATION SHADER ****/ gsnSetPixel(vec4(missing)); }\n");
  const RenderRequest request = makeRequest(4);
  std::shared_ptr<PreparedScene> scene;
  const ResolvedJob broken = resolve(request, program::loadProgram((folder / "broken.rt.glsl").string()));
  EXPECT_THROW(RenderJob(testEngine(), broken, observer_, scene), ProgramError);
  ASSERT_TRUE(scene);
  const PreparedScene* loaded = scene.get();
  RenderJob job(testEngine(), resolve(request, program::loadProgram("normals")), observer_, scene);
  EXPECT_EQ(scene.get(), loaded);
  EXPECT_EQ(job.run(request.limits, observer_).provenance.samples, 4u);
}

// A program whose any-hit shader could count needs acceleration structures that call it once per intersection.
TEST_F(RenderJobTest, ScenesAreRebuiltForAnyHitShaders) {
  const quintet::test::TempFolder folder;
  const auto write = [&](const std::string& anyHit) {
    writeFile(folder / "a.rt.glsl",
              "struct RayPayloadType { vec3 color; };\n"
              "void main() { /**** RAY GENERATION SHADER ****/ gsnSetPixel(vec4(0.5)); }\n" +
                  anyHit);
    return program::loadProgram((folder / "a.rt.glsl").string());
  };
  const RenderRequest request = makeRequest(1);
  std::shared_ptr<PreparedScene> scene;
  const RenderJob first(testEngine(), resolve(request, write("")), observer_, scene);
  const std::shared_ptr<PreparedScene> plain = scene;
  const program::Program counting = write("void main() { /**** ANY-HIT SHADER ****/ payload.color += 0.1; }\n");
  const RenderJob second(testEngine(), resolve(request, counting), observer_, scene);
  EXPECT_NE(scene, plain);
  EXPECT_EQ(scene->singleAnyHit, program::SingleAnyHit::all);
  const std::shared_ptr<PreparedScene> single = scene;
  const RenderJob third(testEngine(), resolve(request, write("")), observer_, scene);
  EXPECT_EQ(scene, single);
}

TEST_F(RenderJobTest, WatchingReportsABrokenProgramAndRecovers) {
  const quintet::test::TempFolder folder;
  const std::string program = (folder / "a.rt.glsl").string();
  const auto write = [&](const char* value) {
    writeFile(program, std::string("struct RayPayloadType { vec3 color; };\n"
                                   "void main() { /**** RAY GENERATION SHADER ****/ gsnSetPixel(vec4(") +
                           value + ")); }\n");
  };
  const RenderRequest request = makeRequest(1);
  write("missing");
  LiveJob live(testEngine(), program, [&] { return resolve(request, program::loadProgram(program)); });
  EXPECT_FALSE(live.reload(observer_));
  EXPECT_FALSE(observer_.reported.empty());
  EXPECT_EQ(live.job(), nullptr);
  EXPECT_THAT(live.watcher().watched().files, testing::ElementsAre(program));
  write("0.5");
  EXPECT_THAT(live.watcher().wait(10.0), testing::Not(testing::IsEmpty()));
  EXPECT_EQ(live.watcher().changedNames(), "a.rt.glsl");
  ASSERT_TRUE(live.reload(observer_));
  EXPECT_EQ(live.job()->run(request.limits, observer_).provenance.samples, 1u);
}

}  // namespace
}  // namespace quintet::job
