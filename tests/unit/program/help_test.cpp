// SPDX-License-Identifier: Apache-2.0
// The description of a program as help text and JSON, and the list of built-in programs.
#include "program/help.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "program/load.h"
#include "program/program_test_support.h"

namespace quintet::program {
namespace {

using testing::HasSubstr;

TEST(ProgramHelp, DescribesTheProgramAsJson) {
  const auto json = nlohmann::json::parse(describeAsJson(parse(kParameters, parameterFiles())));
  EXPECT_EQ(json["name"], "demo");
  EXPECT_EQ(json["description"], "a test");
  EXPECT_EQ(json["accumulation"], "film");
  EXPECT_EQ(json["rays"], nlohmann::json::array({"radiance"}));
  EXPECT_EQ(
      json["outputs"][1],
      nlohmann::json::parse(
          R"({"name":"where","kind":"normal","pixel":"mean","optional":false,"channels":["X","Y","Z"],"help":"the normal"})"));
  const auto& p = json["parameters"];
  ASSERT_EQ(p.size(), 8u);
  EXPECT_EQ(p[0], nlohmann::json::parse(
                      R"({"name":"on","type":"bool","default":true,"min":null,"max":null,"unit":"","help":""})"));
  EXPECT_EQ(p[1], nlohmann::json::parse(
                      R"({"name":"bounces","type":"int","default":12,"min":0,"max":64,"unit":"","help":"how often"})"));
  EXPECT_EQ(p[3], nlohmann::json::parse(
                      R"({"name":"far","type":"float","default":0.1,"min":0.0,"max":null,"unit":"m","help":""})"));
  EXPECT_EQ(p[4]["default"], nlohmann::json::parse("[1.0,0.5,0.25]"));
  EXPECT_EQ(p[5],
            nlohmann::json::parse(
                R"({"name":"mode","type":"choice","default":"heat","choices":["plain","heat"],"unit":"","help":""})"));
  EXPECT_EQ(p[6],
            nlohmann::json::parse(
                R"({"name":"wood","type":"image","default":"wood.png","encoding":"linear","unit":"","help":""})"));
  EXPECT_EQ(p[7]["encoding"], "srgb");
}

TEST(ProgramHelp, DescribesTheProgramAsText) {
  const std::string text = describeAsText(parse(kParameters, parameterFiles()));
  for (const char* part : {"demo: a test", "bounces", "how often", "int, default 12, at least 0, at most 64",
                           "float, default 0.1 m, at least 0", "choice, default heat, one of plain, heat",
                           "image, default wood.png", "image, default white", "where", "the normal"})
    EXPECT_THAT(text, HasSubstr(part));
  EXPECT_THAT(describeAsText(parse(kSmall)), HasSubstr("none"));
}

TEST(ProgramHelp, ListsTheBuiltInPrograms) {
  const auto json = nlohmann::json::parse(listAsJson());
  const std::vector<std::string> names = builtInPrograms();
  const std::string text = listAsText();
  ASSERT_EQ(json.size(), names.size());
  EXPECT_EQ(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(json[i]["name"], names[i]);
    EXPECT_FALSE(json[i]["description"].get<std::string>().empty());
    EXPECT_THAT(text, HasSubstr(names[i] + " "));
  }
}

}  // namespace
}  // namespace quintet::program
