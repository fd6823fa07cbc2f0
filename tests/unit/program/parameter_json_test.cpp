// Parameters as JSON: values in and out, what is refused, and a program's description.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "program/program_json.h"
#include "program_test_support.h"

namespace quintet::program {
namespace {

const std::string kToml = std::string(kSmall) + R"(
[[output]]
name = "color"
[[output]]
name = "where"
kind = "normal"
help = "the normal"
[[parameter]]
name = "on"
type = "bool"
default = true
[[parameter]]
name = "bounces"
type = "int"
default = 12
min = 0
max = 64
help = "how often"
[[parameter]]
name = "count"
type = "uint"
default = 3
[[parameter]]
name = "far"
type = "float"
default = 0.1
min = 0
unit = "m"
[[parameter]]
name = "tint"
type = "color"
default = [1, 0.5, 0.25]
max = 1
[[parameter]]
name = "mode"
type = "choice"
choices = ["plain", "heat"]
default = "heat"
[[parameter]]
name = "wood"
type = "image"
default = "wood.png"
encoding = "linear"
[[parameter]]
name = "map"
type = "image"
default = ""
)";

Files files() {
  Files all = someFiles();
  all["wood.png"] = "";
  return all;
}

ParameterValues values() { return ParameterValues(parse(kToml, files()).parameters); }

// "/tint: what is wrong"
std::string problem(const std::string& json) {
  ParameterValues v = values();
  const std::string before = v.describe();
  try {
    v.setFromJson(json, "folder/values.json");
  } catch (const FileError& error) {
    EXPECT_EQ(error.file(), "folder/values.json");
    EXPECT_EQ(v.describe(), before) << "nothing is set by a file that is wrong";
    return error.place() + ": " + error.problem();
  }
  return {};
}

TEST(ParameterJson, SetsEveryType) {
  ParameterValues v = values();
  v.setFromJson(
      R"({"on": false, "bounces": 3.0, "count": 4294967295, "far": 2.5, "tint": [0, 0.125, 1], "mode": "plain", "wood": "a.png", "map": ""})",
      "folder/values.json");
  EXPECT_EQ(v.describe(),
            "on=false bounces=3 count=4294967295 far=2.5 tint=0,0.125,1 mode=plain wood=folder/a.png map=");
  v.setFromJson(R"({"wood": "/abs/b.png"})", "folder/values.json");
  EXPECT_EQ(v.images()[0].file, "/abs/b.png");
  v.setFromJson("{}", "x");
  EXPECT_EQ(v.get("bounces")[0], 3) << "what is not named stays";
  v.setFromJson(R"({"bounces": 4, "bounces": 5})", "x");
  EXPECT_EQ(v.get("bounces")[0], 5);
}

TEST(ParameterJson, GoesOutAndComesBack) {
  ParameterValues v = values();
  EXPECT_EQ(v.toJson(), R"({"on":true,"bounces":12,"count":3,"far":0.1,"tint":[1.0,0.5,0.25],"mode":"heat"})");
  v.set("far", "0.30000000000000004");
  v.set("mode", "plain");
  v.set("map", "x/y.png");
  ParameterValues other = values();
  other.setFromJson(v.toJson(), "values.json");
  EXPECT_EQ(other.toJson(), v.toJson());
  EXPECT_EQ(other.get("far")[0], 0.30000000000000004);
  EXPECT_EQ(other.images()[1].file, "x/y.png");
  EXPECT_TRUE(other.images()[0].ofProgram);
}

TEST(ParameterJson, SaysWhatIsWrong) {
  EXPECT_EQ(problem(R"({"tnt": 1})"), "/tnt: no parameter 'tnt'; did you mean 'tint'?");
  EXPECT_EQ(problem(R"({"on": true, "a~b/c": 1})").substr(0, 10), "/a~0b~1c: ");
  EXPECT_EQ(problem(R"({"on": "true"})"), "/on: parameter 'on': 'true' is not a bool");
  EXPECT_EQ(problem(R"({"bounces": 1.5})"), "/bounces: parameter 'bounces': '1.5' is not an int");
  EXPECT_EQ(problem(R"({"bounces": true})"), "/bounces: parameter 'bounces': 'true' is not an int");
  EXPECT_EQ(problem(R"({"bounces": null})"), "/bounces: parameter 'bounces': 'null' is not an int");
  EXPECT_EQ(problem(R"({"bounces": 65})"), "/bounces: parameter 'bounces': 65 is outside 0 … 64");
  EXPECT_EQ(problem(R"({"far": -1})"), "/far: parameter 'far': -1 is outside 0 … 1e+30");
  EXPECT_EQ(problem(R"({"far": 1e300})"), "/far: parameter 'far': 1e+300 is outside 0 … 1e+30");
  EXPECT_EQ(problem(R"({"tint": [1, 1]})"), "/tint: parameter 'tint': '[1,1]' is not a color (3 numbers with commas)");
  EXPECT_EQ(problem(R"({"tint": [1, "1", 1]})"),
            "/tint: parameter 'tint': '[1,\"1\",1]' is not a color (3 numbers with commas)");
  EXPECT_EQ(problem(R"({"tint": {"r": 1}})"), "/tint: parameter 'tint': '{…}' is not a color (3 numbers with commas)");
  EXPECT_EQ(problem(R"({"tint": [1, 1, 2]})"), "/tint: parameter 'tint': [1,1,2] is outside -1e+30 … 1");
  EXPECT_EQ(problem(R"({"mode": "haet"})"), "/mode: parameter 'mode': there is no choice 'haet'; did you mean 'heat'?");
  EXPECT_EQ(problem(R"({"mode": 0})"), "/mode: parameter 'mode': there is no choice '0'; there are: plain, heat");
  EXPECT_EQ(problem(R"({"wood": 3})"), "/wood: parameter 'wood': '3' is not an image file's name");
  EXPECT_EQ(problem("[1]"), ": the values of parameters are an object such as {\"tint\": [1, 0.5, 0]}");
  EXPECT_EQ(problem("{\"on\": tru}"), "byte 11: this is not JSON");
  EXPECT_EQ(problem(""), "byte 1: this is not JSON");
  EXPECT_EQ(problem("{\"far\": 1e999}").empty(), false);
}

TEST(ParameterJson, SurvivesDepthAndNonsense) {
  const std::string deep(1u << 20, '[');
  EXPECT_FALSE(problem("{\"tint\": " + deep + "}").empty());
  EXPECT_FALSE(problem("{\"tint\": " + deep + std::string(deep.size(), ']') + "}").empty());
  EXPECT_FALSE(problem("{\"on\": \"\xff\xfe\"}").empty());
  EXPECT_FALSE(problem(std::string("{\"map\": \"a\\u0000b\"}")).empty());
}

TEST(ProgramJson, DescribesWhatThereIs) {
  const auto json = nlohmann::json::parse(describeAsJson(parse(kToml, files())));
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

}  // namespace
}  // namespace quintet::program
