// SPDX-License-Identifier: Apache-2.0
// Explanations as JSON: what is written can be read, and wrong files are errors with a location.
#include "job/explanation_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "explanations.h"

namespace quintet::job {
namespace {

std::string problemOf(const std::string& text) {
  try {
    parseExplanation(text, "a.json");
  } catch (const FileError& error) {
    return error.what();
  }
  return {};
}

TEST(ExplanationJson, IsReadBack) {
  const PixelExplanation before = somePath();
  const PixelExplanation after = parseExplanation(explanationJson(before), "a.json");
  EXPECT_EQ(after.scene, before.scene);
  EXPECT_EQ(after.pixel, before.pixel);
  EXPECT_EQ(after.sample, before.sample);
  EXPECT_FALSE(after.frames);
  EXPECT_EQ(after.outputs[0].value, before.outputs[0].value);
  EXPECT_EQ(after.events, before.events);
}

TEST(ExplanationJson, KeepsEachBitOfFloats) {
  PixelExplanation e = somePath();
  e.frames = true;
  e.outputs[0].value = {0.1f, 1.17549435e-38f, 3.40282347e38f, 16777217.0f};
  const float infinity = std::numeric_limits<float>::infinity();
  e.events = {{"roulette", {{"u", 1.0f / 3.0f}, {"values", std::vector<float>{1.0f, -infinity, infinity}}}, {}}};
  const PixelExplanation after = parseExplanation(explanationJson(e), "a.json");
  EXPECT_EQ(after.outputs[0].value, e.outputs[0].value);
  EXPECT_EQ(after.events, e.events);
  EXPECT_TRUE(after.frames);
}

TEST(ExplanationJson, KeepsNan) {
  PixelExplanation e = somePath();
  e.events = {{"contribution", {{"value", std::vector<float>{NAN, 1.0f, 2.0f}}, {"n", NAN}}, {}}};
  const PixelExplanation after = parseExplanation(explanationJson(e), "a.json");
  EXPECT_TRUE(std::isnan(after.events[0].vector("value").x));
  EXPECT_TRUE(std::isnan(after.events[0].number("n")));
}

TEST(ExplanationJson, KeepsTheOriginOfAValueThatIsNotFinite) {
  PixelExplanation e = somePath();
  EXPECT_FALSE(parseExplanation(explanationJson(e), "a.json").origin);
  e.origin = ValueOrigin{{"sky/sky.rmiss", 6, 0}, "sky.rmiss", "division", true};
  const std::optional<ValueOrigin> after = parseExplanation(explanationJson(e), "a.json").origin;
  ASSERT_TRUE(after);
  EXPECT_EQ(after->location.file, "sky/sky.rmiss");
  EXPECT_EQ(after->location.line, 6);
  EXPECT_EQ(after->operation, "division");
  EXPECT_TRUE(after->isNan);
  EXPECT_EQ(originText(*after), "the result of this division is NaN");
  std::string wrong = explanationJson(e);
  wrong.replace(wrong.find("\"division\""), 10, "7");
  EXPECT_THAT(problemOf(wrong), testing::HasSubstr("/origin/operation"));
}

// Users can choose names that are also texts of numbers.
TEST(ExplanationJson, KeepsNames) {
  PixelExplanation e = somePath();
  e.events[0].children[0].set("instanceName", std::string("inf"));
  e.events[0].children[0].set("material", std::string("-inf"));
  e.events[0].children[0].set("stage", std::string("nan"));
  e.events[1] = {"light", {{"light", std::string("nan")}}, {}};
  EXPECT_EQ(parseExplanation(explanationJson(e), "a.json").events, e.events);
  auto json = nlohmann::json::parse(explanationJson(e));
  json["events"][1]["light"] = 1;
  EXPECT_THAT(problemOf(json.dump()), testing::StartsWith("a.json: /events/1/light: must be a text"));
}

TEST(ExplanationJson, KeepsTextsOfNumbers) {
  PixelExplanation e = somePath();
  ExplainedEvent event{"ray", {}, {}};
  for (const char* name : {"stage",    "file",      "rayType",  "records", "flags",  "missShader", "result",
                           "callable", "variable",  "dataType", "when",    "output", "mode",       "side",
                           "light",    "lightType", "lobe",     "source",  "reason", "material",   "instanceName"})
    event.set(name, std::string("nan"));
  e.events = {event};
  EXPECT_EQ(parseExplanation(explanationJson(e), "a.json").events, e.events);
}

TEST(ExplanationJson, HasContributionsAndTheirSum) {
  const auto json = nlohmann::json::parse(explanationJson(somePath(), "quintet explain-pixel …"));
  EXPECT_EQ(json["command"], "quintet explain-pixel …");
  EXPECT_EQ(json["contributions"].size(), 2u);
  EXPECT_EQ(json["contributions"][1]["source"], "light sample");
  EXPECT_EQ(json["contributions"][1]["ray"], 2);
  EXPECT_EQ(json["contributionSum"], (std::vector<float>{0.75f, 0.5f, 0.25f}));
}

TEST(ExplanationJson, NamesTheLocationOfAnError) {
  EXPECT_THAT(problemOf("{"), testing::StartsWith("a.json: byte 2: not valid JSON"));
  EXPECT_THAT(problemOf("[]"), testing::HasSubstr("not an explanation"));
  auto json = nlohmann::json::parse(explanationJson(somePath()));
  json["formatVersion"] = 99;
  EXPECT_THAT(problemOf(json.dump()), testing::StartsWith("a.json: /formatVersion: not supported"));
  json["formatVersion"] = 1;
  json["outputs"][0]["value"] = {1, 2, 3};
  EXPECT_THAT(problemOf(json.dump()), testing::StartsWith("a.json: /outputs/0/value: must be four numbers"));
  json["outputs"][0]["value"] = {1, 2, 3, 4};
  json["events"][0]["events"][1]["payload.t"] = nullptr;
  EXPECT_THAT(problemOf(json.dump()), testing::StartsWith("a.json: /events/0/events/1/payload.t: must be a text"));
  json["events"][0]["events"][1].erase("type");
  EXPECT_THAT(problemOf(json.dump()), testing::StartsWith("a.json: /events/0/events/1: 'type' is missing"));
}

}  // namespace
}  // namespace quintet::job
