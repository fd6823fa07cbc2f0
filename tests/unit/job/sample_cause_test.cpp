// SPDX-License-Identifier: Apache-2.0
// Which event explains a sample that is not finite, or a firefly.
#include <gtest/gtest.h>

#include <cmath>

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

TEST(SampleCause, IsEmptyIfNothingIsStated) {
  PixelExplanation e = somePath();
  e.events.clear();
  EXPECT_EQ(causeOf(e, true).event, "");
  EXPECT_EQ(causeOf(e, false).bounce, -1);
}

}  // namespace
}  // namespace quintet::job
