// SPDX-License-Identifier: Apache-2.0
// The text of an explanation and of a difference.
#include "output/explanation_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "../job/explanations.h"
#include "base/wrap.h"

namespace quintet::output {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::size_t kWidth = 80;

// Lines that are longer than the width, except those that are one word.
std::size_t longestLine(const std::string& text) {
  std::size_t longest = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    longest = std::max(longest, columnsOf(std::string_view(text).substr(at, end - at)));
    at = end + 1;
  }
  return longest;
}

TEST(ExplanationText, StatesSampleValueAndContributions) {
  const std::string text = explanationText(job::somePath(), kWidth);
  EXPECT_THAT(text, HasSubstr("room.glb: pixel 3,4 of 640x480, sample 5 of 64, seed 0\n"));
  EXPECT_THAT(text, HasSubstr("program pathtracer on device; bounces=12\n"));
  EXPECT_THAT(text, HasSubstr("color            0.75 0.5 0.25, alpha 1\n"));
  EXPECT_THAT(text, testing::ContainsRegex("ray 2: light sample, 1 scattering event +0.25 +0.25 +0.25\n"));
  EXPECT_THAT(text, testing::ContainsRegex("sum +0.75 +0.5 +0.25\n"));
  EXPECT_THAT(text, Not(HasSubstr("The sum is not")));
  EXPECT_LE(longestLine(text), kWidth);
}

TEST(ExplanationText, NumbersRaysAndIndentsTheirEvents) {
  const std::string text = explanationText(job::somePath(), kWidth);
  EXPECT_THAT(text, HasSubstr("Ray 1: radiance, main.rgen:12\n"
                              "  origin         0 1 5\n"
                              "  direction      0 0 -1\n"
                              "  t              0 to infinity\n"
                              "  hit            \"floor\" (instance 0), geometry 0, triangle 7, t 2.5\n"));
  EXPECT_THAT(text, HasSubstr("  contribution   0.5 0.25 0\n\nRay 2: shadow"));
}

TEST(ExplanationText, ShowsPayloadsOnRequestAndForProgramsWithoutContributions) {
  job::PixelExplanation e = job::somePath();
  job::ExplainedEvent before = e.events[0].children[1];
  before.set("when", std::string("before"));
  before.set("payload.t", 0.0f);
  e.events[0].children.insert(e.events[0].children.begin(), before);
  const std::string line = "payload        t 0 -> 2.5, ids 1 -2\n";
  EXPECT_THAT(explanationText(e, kWidth), Not(HasSubstr(line)));
  EXPECT_THAT(explanationText(e, kWidth, true), HasSubstr(line));
  std::erase_if(e.events, [](const job::ExplainedEvent& event) { return event.type == "contribution"; });
  EXPECT_THAT(explanationText(e, kWidth), HasSubstr(line));
}

TEST(ExplanationText, ShowsPayloadsWithoutMembers) {
  job::PixelExplanation e = job::somePath();
  e.events[0].children[1] = {"payload",
                             {{"when", std::string("before")},
                              {"variable", std::string("visible")},
                              {"dataType", std::string("float")},
                              {"value", 0.5f}},
                             {}};
  EXPECT_THAT(explanationText(e, kWidth, true), HasSubstr("  payload        visible 0.5\n"));
}

TEST(ExplanationText, WritesInfinityAsJsonText) {
  job::PixelExplanation b = job::somePath();
  b.events[0].children[0].set("t", INFINITY);
  const std::string json = explanationDiffJson(job::diffExplanations(job::somePath(), b), "left", "right.json");
  EXPECT_THAT(json, HasSubstr("\"difference\":\"inf\""));
}

TEST(ExplanationText, ReportsWhatDoesNotAddUp) {
  job::PixelExplanation e = job::somePath();
  e.outputs[0].value.r = 0.9f;
  e.discarded = false;
  e.lostRecords = 2;
  const std::string text = explanationText(e, kWidth);
  EXPECT_THAT(text, AllOf(HasSubstr("sum"), HasSubstr("'color'")));
  EXPECT_THAT(text, AllOf(HasSubstr("instrumented"), HasSubstr("0.75 0.5 0.25")));
  EXPECT_THAT(text, HasSubstr("2 records"));
  e = job::somePath();
  e.discarded = true;
  e.outputs[0].value = e.outputs[0].recorded = vec4(0.0f);
  EXPECT_THAT(explanationText(e, kWidth), HasSubstr("discarded"));
  EXPECT_THAT(explanationText(e, kWidth), Not(HasSubstr("The sum is not")));
}

TEST(ExplanationText, ShowsTheFirstDifference) {
  job::PixelExplanation b = job::somePath();
  b.events[0].children[0].set("t", 3.5f);
  b.device = "other";
  const job::ExplanationDiff diff = job::diffExplanations(job::somePath(), b);
  const std::string text = explanationDiffText(diff, "left", "right.json", kWidth);
  EXPECT_THAT(text, HasSubstr("A: left\nB: right.json\n"));
  EXPECT_THAT(text, HasSubstr("device\n  A  device\n  B  other\n"));
  EXPECT_THAT(text, HasSubstr("The first difference, after 1 equal event:\n"
                              "ray 1, closest-hit surface.rchit: t\n  A  2.5\n  B  3.5\n  difference 1\n"));
  EXPECT_THAT(text, HasSubstr("The values of the outputs are equal.\n"));
  const auto json = nlohmann::json::parse(explanationDiffJson(diff, "left", "right.json"));
  EXPECT_EQ(json["equal"], false);
  EXPECT_EQ(json["first"]["location"], "ray 1, closest-hit surface.rchit: t");
  EXPECT_EQ(json["first"]["difference"], 1.0);
}

}  // namespace
}  // namespace quintet::output
