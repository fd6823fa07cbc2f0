// SPDX-License-Identifier: Apache-2.0
// The report of a search: counts, causes, and the command that explains a sample.
#include "output/search_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace quintet::output {
namespace {

using testing::HasSubstr;

std::string commandFor(const job::FoundSample& found) {
  return fmt::format("quintet explain-pixel room.glb --spp 64 --pixel {},{} --sample {}", found.pixel.x, found.pixel.y,
                     found.sample);
}

job::SearchResult someResult() {
  job::SearchResult result;
  result.samples = 64;
  result.notFiniteCount = result.notFiniteGroups = 3;
  result.fireflyCount = result.fireflyGroups = 1;
  job::FoundSample bad;
  bad.pixel = {12, 40};
  bad.sample = 17;
  bad.value = {NAN, INFINITY, 1.0f};
  bad.cause = {3, "transmission", "glass", "vase", "bsdf", "weight", "glass", false};
  result.notFinite = {bad};
  job::FoundSample firefly;
  firefly.pixel = {1, 2};
  firefly.sample = 5;
  firefly.luminance = 300;
  firefly.level = 1.5f;
  firefly.cause = {2, "diffuse", "wall", "room", "contribution", "", "floor", true};
  result.fireflies = {firefly};
  return result;
}

TEST(SearchReport, NamesTheCauseAndTheCommand) {
  EXPECT_EQ(searchText(someResult(), commandFor, 100),
            "3 samples that are not finite, of which 1 is listed\n"
            "  pixel 12,40, sample 17: nan infinity 1\n"
            "    3 bounces, transmission lobe of material \"glass\", instance \"vase\", weight of bsdf is not finite\n"
            "    quintet explain-pixel room.glb --spp 64 --pixel 12,40 --sample 17\n"
            "\n"
            "1 firefly\n"
            "  pixel 1,2, sample 5: luminance 300, 200 times that of its surroundings\n"
            "    2 bounces, diffuse lobe of material \"floor\", then material \"wall\", instance \"room\"\n"
            "    quintet explain-pixel room.glb --spp 64 --pixel 1,2 --sample 5\n");
  job::SearchResult dark = someResult();
  dark.fireflies[0].level = 0;
  EXPECT_THAT(searchText(dark, commandFor, 100), HasSubstr("sample 5: luminance 300 in black surroundings\n"));
  job::SearchResult nothing;
  nothing.samples = 64;
  EXPECT_EQ(searchText(nothing, commandFor, 100), "nothing found in 64 samples per pixel\n");
  nothing.frames = true;
  EXPECT_EQ(searchText(nothing, commandFor, 100), "nothing found in 64 frames\n");
  job::SearchResult frames = someResult();
  frames.frames = true;
  EXPECT_THAT(searchText(frames, commandFor, 100), HasSubstr("3 pixels that are not finite, of which 1 is listed\n"
                                                             "  pixel 12,40, frame 17: nan"));
}

TEST(SearchReport, StatesTheGroupsOfAdjacentPixels) {
  job::SearchResult result = someResult();
  result.notFiniteCount = 19;
  result.notFiniteGroups = 3;
  result.notFinite[0].groupPixels = 4;
  result.notFinite[0].groupSamples = 16;
  result.notFinite[0].least = {10, 40};
  result.notFinite[0].most = {13, 41};
  const std::string text = searchText(result, commandFor, 100);
  EXPECT_THAT(text, testing::StartsWith("19 samples that are not finite in 3 groups of adjacent pixels, of which 1 is "
                                        "listed\n  pixel 12,40, sample 17: nan infinity 1 (4 adjacent pixels from "
                                        "10,40 to 13,41; 16 samples)\n"));
  const auto json = nlohmann::json::parse(searchJson(result, commandFor));
  EXPECT_EQ(json["notFiniteGroups"], 3);
  const nlohmann::json group{{"pixels", 4}, {"samples", 16}, {"from", {10, 40}}, {"to", {13, 41}}};
  EXPECT_EQ(json["notFinite"][0]["group"], group);
  result.notFinite[0].groupPixels = 1;
  EXPECT_THAT(searchText(result, commandFor, 100), HasSubstr("nan infinity 1 (16 samples of this pixel)\n"));
}

TEST(SearchReport, HasTheSameAsJson) {
  job::SearchResult result = someResult();
  result.fireflies[0].value = vec3(0.1f);
  EXPECT_THAT(searchJson(result, commandFor), HasSubstr("\"value\":[0.1,0.1,0.1]")) << "not the digits of a double";
  const auto json = nlohmann::json::parse(searchJson(result, commandFor));
  EXPECT_EQ(json["notFiniteCount"], 3);
  EXPECT_EQ(json["notFinite"][0]["value"], (nlohmann::json{"nan", "inf", 1.0}));
  EXPECT_EQ(json["notFinite"][0]["lobe"], "transmission");
  EXPECT_EQ(json["notFinite"][0]["field"], "weight");
  EXPECT_EQ(json["fireflies"][0]["bounce"], 2);
  EXPECT_EQ(json["fireflies"][0]["lobeMaterial"], "floor");
  EXPECT_EQ(json["fireflies"][0]["field"], nullptr);
  EXPECT_THAT(json["fireflies"][0]["command"].get<std::string>(), HasSubstr("--pixel 1,2 --sample 5"));
}

}  // namespace
}  // namespace quintet::output
