// SPDX-License-Identifier: Apache-2.0
// quintet find: samples that are not finite, and fireflies, each explained.
#include "job/sample_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "../render/scene_builder.h"
#include "base/error.h"
#include "program/load.h"

namespace quintet::job {
namespace {

Engine& engine() {
  static Engine engine({});
  return engine;
}

SearchResult search(const char* program, RenderRequest request, const SearchOptions& options) {
  Observer observer;
  RenderJob job(engine(), resolve(std::move(request), program::loadProgram(program)), observer);
  return searchSamples(engine(), job, options, observer);
}

// A floor under a small lamp: paths without light sampling seldom hit it.
RenderRequest lampRequest() {
  test::SceneBuilder builder;
  builder.add(test::quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}), test::lambert(vec3(0.5f)));
  builder.add(test::quad({-0.2f, 3, -0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f}), test::emitter(vec3(500.0f)));
  builder.scene.materials[0].name = "floor";
  builder.camera(test::perspective({0, 2, 5}, {0, 0, 0}, 40.0f));
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
    EXPECT_NEAR(0.2126f * firefly.value.r + 0.7152f * firefly.value.g + 0.0722f * firefly.value.b, firefly.luminance,
                1e-4f * firefly.luminance);
    EXPECT_EQ(firefly.cause.bounce, 1);
    EXPECT_EQ(firefly.cause.lobe, "diffuse");
    EXPECT_EQ(firefly.cause.event, "contribution");
  }
}

TEST(SampleSearch, FindsSamplesThatAreNotFinite) {
  RenderRequest request = lampRequest();
  request.environment.source = "2,2,2";
  request.environment.intensity = 3e38f;  // the radiance is infinite
  request.limits.samples = 2;
  const SearchResult found =
      search("naive", request, {.notFinite = true, .fireflies = false, .threshold = 2, .limit = 4});
  // Every path of this scene leaves it, except those that hit the lamp.
  EXPECT_GT(found.notFiniteCount, 700u);
  EXPECT_LE(found.notFiniteCount, 24u * 16u * 2u);
  ASSERT_EQ(found.notFinite.size(), 4u);
  EXPECT_EQ(found.notFinite[0].sample, 0u);
  EXPECT_FALSE(std::isfinite(found.notFinite[0].value.x));
  EXPECT_EQ(found.notFinite[0].cause.event, "emission");
  EXPECT_EQ(found.notFinite[0].cause.field, "radiance");
}

TEST(SampleSearch, RequiresANumberOfSamples) {
  RenderRequest request = lampRequest();
  request.limits.samples.reset();
  request.limits.seconds = 1.0;
  request.assignments.clear();
  EXPECT_THROW(search("normals", request, {}), UsageError);
  request = lampRequest();
  request.limits.samples = 3;
  request.assignments.clear();
  EXPECT_THROW(search("normals", request, {}), UsageError);
}

}  // namespace
}  // namespace quintet::job
