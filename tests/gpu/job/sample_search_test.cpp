// SPDX-License-Identifier: Apache-2.0
// quintet find: samples that are not finite, and fireflies, each explained.
#include "job/sample_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../render/scene_builder.h"
#include "base/error.h"
#include "base/file.h"
#include "base/luminance.h"
#include "infinite_sky.h"
#include "job/test_engine.h"
#include "program/load.h"
#include "temp_folder.h"

namespace quintet::job {
namespace {

SearchResult search(const std::string& program, RenderRequest request, const SearchOptions& options) {
  Observer observer;
  RenderJob job(testEngine(), resolve(std::move(request), program::loadProgram(program)), observer);
  return searchSamples(testEngine(), job, options, observer);
}

// A floor under a small lamp: paths without light sampling seldom hit it.
RenderRequest lampRequest() {
  quintet::test::SceneBuilder builder;
  builder.add(quintet::test::quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}), quintet::test::lambert(vec3(0.5f)));
  builder.add(quintet::test::quad({-0.2f, 3, -0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f}), quintet::test::emitter(vec3(500.0f)));
  builder.scene.materials[0].name = "floor";
  builder.camera(quintet::test::perspective({0, 2, 5}, {0, 0, 0}, 40.0f));
  RenderRequest request;
  request.loadedScene = std::make_shared<scene::Scene>(std::move(builder.scene));
  request.environment.source = "0.2,0.2,0.2";
  request.size = {24, 16};
  request.limits.samples = 16;
  request.assignments = {"bounces=2"};
  return request;
}

TEST(SampleSearch, FindsFirefliesAndTheirCauses) {
  const SearchResult found =
      search("naive", lampRequest(), {.notFinite = true, .fireflies = true, .threshold = 2, .limit = 3});
  EXPECT_EQ(found.samples, 16u);
  EXPECT_EQ(found.notFiniteCount, 0u);
  ASSERT_GT(found.fireflyCount, 3u);
  ASSERT_EQ(found.fireflies.size(), 3u);
  for (const FoundSample& firefly : found.fireflies) {
    // The explained sample is the one that was found.
    EXPECT_NEAR(luminance(firefly.value), firefly.luminance, 1e-4f * firefly.luminance);
    EXPECT_EQ(firefly.cause.bounce, 1);
    EXPECT_EQ(firefly.cause.lobe, "diffuse");
    EXPECT_EQ(firefly.cause.event, "contribution");
  }
}

TEST(SampleSearch, FindsSamplesThatAreNotFinite) {
  const quintet::test::InfiniteSky program;
  RenderRequest request = lampRequest();
  request.environment.source = "2,2,2";
  request.limits.samples = 2;
  request.assignments.clear();
  const SearchResult found =
      search(program.path(), request, {.notFinite = true, .fireflies = false, .threshold = 2, .limit = 4});
  // Some camera rays hit the floor.
  EXPECT_GT(found.notFiniteCount, 50u);
  EXPECT_LT(found.notFiniteCount, 24u * 16u * 2u);
  ASSERT_EQ(found.notFinite.size(), 1u) << "one group of pixels";
  EXPECT_EQ(found.notFiniteGroups, 1u);
  EXPECT_EQ(found.notFinite[0].groupSamples, found.notFiniteCount);
  EXPECT_EQ(found.notFinite[0].sample, 0u);
  EXPECT_FALSE(std::isfinite(found.notFinite[0].value.x));
  EXPECT_EQ(found.notFinite[0].cause.event, "emission");
  EXPECT_EQ(found.notFinite[0].cause.field, "radiance");
}

// A wall hides the sky, which is infinite, in the first frame only.
TEST(SampleSearch, SearchesTheRequestedFrame) {
  quintet::test::SceneBuilder builder;
  builder.add(quintet::test::quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}), quintet::test::lambert(vec3(0.5f)));
  const quintet::test::InfiniteSky program;
  builder.scene.instances[0].keyframes = {{.frame = 0}, {.frame = 2, .translation = {0, 100, 0}}};
  builder.camera(quintet::test::perspective({0, 0, 5}, {0, 0, 0}, 40.0f));
  RenderRequest request = lampRequest();
  request.loadedScene = std::make_shared<scene::Scene>(std::move(builder.scene));
  request.environment.source = "2,2,2";
  request.limits.samples = 1;
  request.assignments.clear();
  const SearchOptions options{.notFinite = true, .fireflies = false, .limit = 1};
  EXPECT_EQ(search(program.path(), request, options).notFiniteCount, 0u);
  request.frames = {.count = 1, .first = 2};
  const SearchResult found = search(program.path(), request, options);
  EXPECT_EQ(found.notFiniteCount, 24u * 16u);
  ASSERT_EQ(found.notFinite.size(), 1u);
  EXPECT_EQ(found.notFinite[0].cause.event, "emission") << "the explained frame is a different one";
}

TEST(SampleSearch, RequiresANumberOfSamples) {
  RenderRequest request = lampRequest();
  request.limits.samples.reset();
  request.limits.seconds = 1.0;
  request.assignments.clear();
  EXPECT_THROW(search("normals", request, {}), UsageError);
}

struct Recorder : Observer {
  void note(const std::string& text) override { notes.push_back(text); }
  void progress(const Progress& state) override { samples.push_back(state.samples); }
  StopRequest stopRequested() override { return samples.size() >= stopAfter ? StopRequest::finish : StopRequest::none; }
  std::vector<std::string> notes;
  std::vector<double> samples;  // of Progress
  std::size_t stopAfter = 1000;
};

// Fireflies that are requested but cannot be found are an error; otherwise they are not searched.
TEST(SampleSearch, FirefliesRequireSamples) {
  const auto problem = [](const char* program, const RenderRequest& request) -> std::string {
    try {
      search(program, request, {.fireflies = true});
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  RenderRequest few = lampRequest(), frames = lampRequest();
  few.limits.samples = 3;
  few.assignments.clear();
  frames.frames.accumulated = 2;
  frames.assignments.clear();
  EXPECT_EQ(problem("normals", few), "fireflies: at least 4 samples per pixel are required, not 3");
  EXPECT_THAT(problem("09_progressive", frames),
              testing::AllOf(testing::StartsWith("fireflies: "), testing::HasSubstr("progressive' accumulates")));
  for (const auto& [program, request] : {std::pair("normals", few), {"09_progressive", frames}}) {
    Recorder observer;
    RenderJob job(testEngine(), resolve(request, program::loadProgram(program)), observer);
    const SearchResult found = searchSamples(testEngine(), job, {}, observer);
    EXPECT_EQ(found.samples, program == std::string("normals") ? 3u : 2u);
    EXPECT_EQ(found.frames, program != std::string("normals"));
    EXPECT_THAT(observer.notes, testing::Contains(testing::StartsWith("fireflies are not searched: ")));
  }
}

// Every third pixel of every third row is not finite.
class DottedProgram {
 public:
  DottedProgram() {
    writeFile(folder_ / "dots.rt.glsl",
              "void main() { /**** RAY GENERATION SHADER ****/\n"
              "  const uvec2 p = gl_LaunchIDEXT.xy;\n"
              "  const float root = sqrt(p.x % 3u == 0u && p.y % 3u == 0u ? -1.0 - frameID : 0.25);\n"
              "  gsnSetPixel(vec4(vec3(root), 1.0));\n"
              "}\n");
    request_ = lampRequest();
    request_.size = {6, 4};
    request_.assignments.clear();
    request_.frames.accumulated = 2;
  }
  SearchResult search(Observer& observer, std::size_t limit) const {
    RenderJob job(testEngine(), resolve(request_, program::loadProgram((folder_ / "dots.rt.glsl").string())), observer);
    return searchSamples(testEngine(), job, {.fireflies = false, .limit = limit}, observer);
  }

 private:
  quintet::test::TempFolder folder_;
  RenderRequest request_;
};

TEST(SampleSearch, ListsEachGroupOfAdjacentPixelsOnce) {
  Recorder observer;
  const SearchResult found = DottedProgram().search(observer, 10);
  EXPECT_EQ(found.notFiniteCount, 4u);
  EXPECT_EQ(found.notFiniteGroups, 4u);
  ASSERT_EQ(found.notFinite.size(), 4u);
  EXPECT_EQ(found.notFinite[3].pixel, uvec2(3, 3));
  EXPECT_EQ(found.notFinite[3].most, uvec2(3, 3));
}

// What is found is reported one by one; a stop leaves out the rest.
TEST(SampleSearch, StopsBetweenExplanations) {
  const DottedProgram program;
  const auto searched = [&](std::size_t stopAfter, std::vector<double>& samples) {
    Recorder observer;
    observer.stopAfter = stopAfter;
    const SearchResult found = program.search(observer, 3);
    samples = observer.samples;
    return found;
  };
  std::vector<double> samples;
  const SearchResult all = searched(1000, samples);
  EXPECT_THAT(samples, testing::ElementsAre(1, 2, 1, 2, 3)) << "of the search, then of the explanations";
  EXPECT_FALSE(all.interrupted);
  const SearchResult part = searched(4, samples);
  EXPECT_TRUE(part.interrupted);
  ASSERT_EQ(part.notFinite.size(), 2u) << "the third one is not explained";
  EXPECT_NE(part.notFinite[1].cause.event, "");
  EXPECT_EQ(part.notFiniteCount, all.notFiniteCount);
  // A stop during the search does not prevent the explanations.
  const SearchResult first = searched(1, samples);
  EXPECT_TRUE(first.interrupted);
  EXPECT_EQ(first.samples, 1u);
  EXPECT_EQ(first.notFinite.size(), 3u);
}

}  // namespace
}  // namespace quintet::job
