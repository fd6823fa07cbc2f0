// SPDX-License-Identifier: Apache-2.0
// The reports of commands as JSON.
#include "output/report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace quintet::output {
namespace {

TEST(ErrorJson, NamesFileAndLocation) {
  const FileError error("a.gltf", "/nodes/0", "is \"broken\"");
  EXPECT_EQ(
      errorJson(error.what(), &error, 1),
      R"({"error":{"message":"a.gltf: /nodes/0: is \"broken\"","file":"a.gltf","location":"/nodes/0","exitStatus":1}})"
      "\n");
}

TEST(ErrorJson, UnknownValuesAreNull) {
  const FileError error("a.gltf", "is missing");
  EXPECT_TRUE(nlohmann::json::parse(errorJson(error.what(), &error, 1))["error"]["location"].is_null());
  const auto json = nlohmann::json::parse(errorJson("wrong", nullptr, 2))["error"];
  EXPECT_TRUE(json["file"].is_null());
  EXPECT_TRUE(json["location"].is_null());
  EXPECT_EQ(json["exitStatus"], 2);
}

job::PrintedLine printedLine(std::string text) {
  job::PrintedLine line;
  line.pixel = {3, 4};
  line.sample = 2;
  line.location = {"p/hit.rchit", 12, 5};
  line.stage = "hit.rchit";
  line.text = std::move(text);
  return line;
}

TEST(PrintedText, NamesLocationPixelAndSample) {
  job::PrintedLine line = printedLine("t = 1.5");
  EXPECT_EQ(printedText(line), "p/hit.rchit:12: pixel 3,4, sample 2: t = 1.5");
  line.frame = 7;
  EXPECT_EQ(printedText(line), "p/hit.rchit:12: pixel 3,4, frame 7, sample 2: t = 1.5");
  line.sample.reset();
  EXPECT_EQ(printedText(line), "p/hit.rchit:12: pixel 3,4, frame 7: t = 1.5");
}

TEST(PrintedText, IndentsFurtherLines) {
  EXPECT_EQ(printedText(printedLine("a\nb\x1b[0m")), "p/hit.rchit:12: pixel 3,4, sample 2: a\n  b?[0m");
}

TEST(PrintedJson, HasTheMembersOfALine) {
  const auto json = nlohmann::json::parse(printedJson(printedLine("a\n\"b\"")))["print"];
  EXPECT_EQ(json, nlohmann::json::parse(R"({"pixel": [3, 4], "sample": 2, "stage": "hit.rchit", "file": "p/hit.rchit",
                                            "line": 12, "text": "a\n\"b\""})"));
}

TEST(ResultJson, HasPrintsOnRequest) {
  job::RenderResult result;
  EXPECT_FALSE(nlohmann::json::parse(resultJson(result, {}, 0.0)).contains("printed"));
  result.printed.emplace();
  result.printed->lines.push_back(printedLine("x"));
  result.printed->omitted = 3;
  const auto json = nlohmann::json::parse(resultJson(result, {}, 0.0))["printed"];
  ASSERT_EQ(json["lines"].size(), 1u);
  EXPECT_EQ(json["lines"][0]["text"], "x");
  EXPECT_EQ(json["omitted"], 3);
}

}  // namespace
}  // namespace quintet::output
