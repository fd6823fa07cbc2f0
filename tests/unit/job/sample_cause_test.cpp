// SPDX-License-Identifier: Apache-2.0
// Which event explains a sample that is not finite, or a firefly.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "explanations.h"
#include "job/sample_search.h"

namespace quintet::job {
namespace {

ExplainedEvent event(const char* type, std::vector<std::pair<std::string, EventValue>> fields) {
  return {type, std::move(fields), {}};
}

// Two surfaces; the path leaves the first one by the diffuse lobe, and the second one by the specular lobe.
PixelExplanation twoBounces(float secondWeight, float lastValue) {
  PixelExplanation e = somePath();
  const auto surface = [](const char* name) { return event("surface", {{"material", std::string(name)}}); };
  const auto bsdf = [](const char* lobe, float weight) {
    return event("bsdf", {{"lobe", std::string(lobe)}, {"useful", true}, {"weight", std::vector<float>{weight, 1, 1}}});
  };
  const auto contribution = [](std::int64_t scatterings, float value) {
    return event("contribution", {{"source", std::string("background")},
                                  {"scatterings", scatterings},
                                  {"value", std::vector<float>{value, value, value}}});
  };
  e.events = {e.events[0],
              surface("wood"),
              contribution(0, 0.5f),
              bsdf("diffuse", 0.5f),
              surface("chrome"),
              bsdf("specular", secondWeight),
              contribution(2, lastValue)};
  return e;
}

TEST(SampleCause, IsTheFirstEventThatIsNotFinite) {
  const SampleCause cause = causeOf(twoBounces(NAN, NAN), true);
  EXPECT_EQ(cause.event, "bsdf");
  EXPECT_EQ(cause.field, "weight");
  EXPECT_EQ(cause.lobe, "specular");
  EXPECT_EQ(cause.material, "chrome");
  EXPECT_EQ(cause.lobeMaterial, "chrome");
  EXPECT_FALSE(cause.lobeIsBefore);
  EXPECT_EQ(cause.instance, "floor");
  EXPECT_EQ(cause.bounce, 1);
}

TEST(SampleCause, IsTheBrightestContributionOfAFirefly) {
  const SampleCause last = causeOf(twoBounces(1.0f, 100.0f), false);
  EXPECT_EQ(last.event, "contribution");
  EXPECT_EQ(last.bounce, 2);
  EXPECT_EQ(last.lobe, "specular");
  EXPECT_EQ(last.field, "");
  const SampleCause first = causeOf(twoBounces(1.0f, 0.25f), false);
  EXPECT_EQ(first.bounce, 0);
  EXPECT_EQ(first.material, "wood");
  EXPECT_EQ(first.lobe, "");
}

// A path over two surfaces: at each, a light is sampled, then the direction in which the path continues, and then the
// shadow ray is traced.
PixelExplanation twoLightSamples(float firstLight, float secondLight) {
  const auto hit = [](const char* type, const char* instance) {
    return event(type, {{"instanceName", std::string(instance)}});
  };
  const auto ray = [](const char* type, ExplainedEvent child) {
    return ExplainedEvent{
        "ray",
        {{"rayType", std::string(type)}, {"tmin", 0.0f}, {"tmax", std::numeric_limits<float>::infinity()}},
        {std::move(child)}};
  };
  const auto surface = [](const char* name) { return event("surface", {{"material", std::string(name)}}); };
  const auto bsdf = [](const char* lobe) { return event("bsdf", {{"lobe", std::string(lobe)}, {"useful", true}}); };
  const auto light = [](std::int64_t scatterings, float value) {
    return event("contribution", {{"source", std::string("light sample")},
                                  {"scatterings", scatterings},
                                  {"value", std::vector<float>{value, value, value}}});
  };
  PixelExplanation e = somePath();
  e.events = {ray("radiance", hit("closest-hit", "floor")),
              surface("wood"),
              bsdf("diffuse"),
              ray("shadow", hit("any-hit", "leaf")),
              light(1, firstLight),
              ray("radiance", hit("closest-hit", "ball")),
              surface("chrome"),
              bsdf("specular"),
              ray("shadow", hit("hit", "wall")),
              light(2, secondLight)};
  return e;
}

TEST(SampleCause, IsTheSurfaceWhoseLightWasSampled) {
  for (const bool notFinite : {false, true}) {
    const float bright = notFinite ? INFINITY : 100.0f;
    const SampleCause first = causeOf(twoLightSamples(bright, 1.0f), notFinite);
    EXPECT_EQ(first.event, "contribution");
    EXPECT_EQ(first.instance, "floor");
    EXPECT_EQ(first.material, "wood");
    EXPECT_EQ(first.lobe, "") << "the path comes from the camera";
    EXPECT_EQ(first.bounce, 1);
    const SampleCause second = causeOf(twoLightSamples(1.0f, bright), notFinite);
    EXPECT_EQ(second.instance, "ball");
    EXPECT_EQ(second.material, "chrome");
    EXPECT_EQ(second.lobe, "diffuse");
    EXPECT_EQ(second.lobeMaterial, "wood") << "not that of the surface whose light was sampled";
    EXPECT_TRUE(second.lobeIsBefore);
    EXPECT_EQ(second.bounce, 2);
  }
}

// The light of a surface is that of the next surface, not of the one with the lobe.
TEST(SampleCause, NamesTheSurfaceOfTheLobe) {
  PixelExplanation e = somePath();
  e.events = {event("surface", {{"material", std::string("wood")}}),
              event("bsdf", {{"lobe", std::string("diffuse")}, {"useful", true}}),
              event("surface", {{"material", std::string("lamp")}}),
              event("contribution", {{"source", std::string("surface")},
                                     {"scatterings", std::int64_t{1}},
                                     {"value", std::vector<float>{9, 9, 9}}})};
  const SampleCause cause = causeOf(e, false);
  EXPECT_EQ(cause.lobe, "diffuse");
  EXPECT_EQ(cause.lobeMaterial, "wood");
  EXPECT_EQ(cause.material, "lamp");
  EXPECT_TRUE(cause.lobeIsBefore);
}

// A ray may be infinitely long, but NaN is an error.
TEST(SampleCause, IsNotAnInfiniteRay) {
  PixelExplanation e = twoLightSamples(1.0f, 1.0f);
  EXPECT_EQ(causeOf(e, true).event, "");
  e.events[3].set("tmax", NAN);
  EXPECT_EQ(causeOf(e, true).event, "ray");
  EXPECT_EQ(causeOf(e, true).field, "tmax");
  e.events[3].set("tmax", 1.0f);
  e.events[3].set("tmin", std::numeric_limits<float>::infinity());
  EXPECT_EQ(causeOf(e, true).field, "tmin");
}

TEST(SampleCause, IsEmptyIfNothingIsStated) {
  PixelExplanation e = somePath();
  e.events.clear();
  EXPECT_EQ(causeOf(e, true).event, "");
  EXPECT_EQ(causeOf(e, false).bounce, -1);
}

}  // namespace
}  // namespace quintet::job
