// SPDX-License-Identifier: Apache-2.0
// Parameters: the values that --set and JSON accept, the errors, and the bytes that shaders read.
#include "program/description/parameter.h"

#include <gmock/gmock.h>

#include <cstring>

#include "base/error.h"
#include "program/program_test_support.h"

namespace quintet::program {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

// Matches a message that contains all words.
auto hasWords(const std::vector<std::string>& words) {
  std::vector<testing::Matcher<std::string>> all;
  for (const std::string& word : words) all.push_back(HasSubstr(word));
  return testing::AllOfArray(all);
}

Parameter make(const std::string& name, ParameterType type, ParameterValue value = {}, double min = -1e30,
               double max = 1e30) {
  Parameter p;
  p.name = name;
  p.type = type;
  p.defaultValue = value;
  p.min = min;
  p.max = max;
  return p;
}

const std::vector<Parameter> kAll = {make("on", ParameterType::boolean, {1}, 0, 1),
                                     make("bounces", ParameterType::integer, {12}, 0, 65536),
                                     make("clamp", ParameterType::real, {0.5}, 0, 10),
                                     make("size", ParameterType::vec2, {1, 2}),
                                     make("up", ParameterType::vec3, {0, 1, 0}),
                                     make("box", ParameterType::vec4, {1, 2, 3, 4}),
                                     make("tint", ParameterType::color, {1, 0.5, 0.25}, 0, 1)};

TEST(Parameter, NamesItsTypes) {
  struct Row {
    ParameterType type;
    const char* name;
    const char* glsl;
    int count;
  };
  for (const Row& row : std::initializer_list<Row>{{ParameterType::boolean, "bool", "uint", 1},
                                                   {ParameterType::integer, "int", "int", 1},
                                                   {ParameterType::real, "float", "float", 1},
                                                   {ParameterType::vec2, "vec2", "vec2", 2},
                                                   {ParameterType::vec3, "vec3", "vec3", 3},
                                                   {ParameterType::vec4, "vec4", "vec4", 4},
                                                   {ParameterType::color, "color", "vec3", 3},
                                                   {ParameterType::uinteger, "uint", "uint", 1},
                                                   {ParameterType::choice, "choice", "uint", 1},
                                                   {ParameterType::image, "image", "uint", 1}}) {
    EXPECT_EQ(typeName(row.type), row.name);
    EXPECT_EQ(glslType(row.type), row.glsl);
    EXPECT_EQ(componentCount(row.type), row.count);
  }
}

TEST(Parameter, StartsWithDefaultsAndIsSetFromText) {
  ParameterValues values(kAll);
  EXPECT_EQ(values.describe(), "on=true bounces=12 clamp=0.5 size=1,2 up=0,1,0 box=1,2,3,4 tint=1,0.5,0.25");
  values.set("on", "false");
  values.set("bounces", "0");
  values.set("clamp", "1e1");  // the upper limit is valid
  values.set("size", "-3,0.25");
  values.setAssignment("up=1,2,3");
  values.setAssignment("box=0,0,0,-1");
  EXPECT_EQ(values.describe(), "on=false bounces=0 clamp=10 size=-3,0.25 up=1,2,3 box=0,0,0,-1 tint=1,0.5,0.25");
  EXPECT_EQ(values.get("size"), (ParameterValue{-3, 0.25, 0, 0}));
  values.set("on", "1");
  EXPECT_EQ(values.get("on")[0], 1);
  EXPECT_THROW(values.get("none"), UsageError);
}

TEST(Parameter, ReportsInvalidValues) {
  ParameterValues values(kAll);
  const auto message = [&](const std::string& name, const std::string& text) {
    try {
      values.set(name, text);
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(message("bonces", "3"), hasWords({"'bonces'", "'bounces'"}));
  EXPECT_THAT(message("qqqqqqqqqqqqqqq", "3"),
              hasWords({"'qqqqqqqqqqqqqqq'", "on, bounces, clamp, size, up, box, tint"}));
  EXPECT_THAT(message("bounces", "3.5"), hasWords({"'bounces'", "'3.5'", "an int"}));
  EXPECT_THAT(message("bounces", "many"), hasWords({"'bounces'", "'many'", "an int"}));
  EXPECT_THAT(message("bounces", "true"), hasWords({"'bounces'", "'true'", "an int"}));
  EXPECT_THAT(message("bounces", ""), hasWords({"'bounces'", "''", "an int"}));
  EXPECT_THAT(message("bounces", "3 "), hasWords({"'bounces'", "'3 '", "an int"}));
  EXPECT_THAT(message("bounces", "-1"), hasWords({"'bounces'", "0 to 65536"}));
  EXPECT_THAT(message("clamp", "nan"), hasWords({"'clamp'", "'nan'", "a float"}));
  EXPECT_THAT(message("clamp", "inf"), hasWords({"'clamp'", "'inf'", "a float"}));
  EXPECT_THAT(message("clamp", "10.001"), hasWords({"'clamp'", "0 to 10"}));
  EXPECT_THAT(message("size", "1"), hasWords({"'size'", "vec2", "2 numbers"}));
  EXPECT_THAT(message("size", "1,2,3"), hasWords({"'size'", "vec2", "2 numbers"}));
  EXPECT_THAT(message("size", "1,"), hasWords({"'size'", "vec2", "2 numbers"}));
  EXPECT_THAT(message("tint", "0,0,2"), hasWords({"'tint'", "0 to 1"}));
  EXPECT_THAT(message("on", "2"), hasWords({"'on'", "0 to 1"}));
  EXPECT_THAT([&] { values.setAssignment("bounces"); },
              ThrowsMessage<UsageError>(hasWords({"'bounces'", "name=value"})));
  EXPECT_THAT([&] { values.setAssignment("=3"); }, ThrowsMessage<UsageError>(hasWords({"'=3'", "name=value"})));
  // None of these changed a value.
  EXPECT_EQ(values.describe(), ParameterValues(kAll).describe());
}

// A uint, a choice and two images.
std::vector<Parameter> more() {
  Parameter count = make("count", ParameterType::uinteger, {4294967295.0}, 0, 4294967295.0),
            mode = make("mode", ParameterType::choice, {1});
  mode.choices = {"plain", "heat", "wire"};
  Parameter wood = make("wood", ParameterType::image), map = make("map", ParameterType::image);
  wood.defaultImage = "wood.png";
  map.sRgb = false;
  return {count, wood, mode, map};
}

TEST(Parameter, SetsChoicesAndImagesFromText) {
  ParameterValues values(more());
  EXPECT_EQ(values.describe(), "count=4294967295 wood=wood.png mode=heat map=");
  values.set("mode", "wire");
  values.set("map", "a b/c=d,e.png");
  EXPECT_EQ(values.describe(), "count=4294967295 wood=wood.png mode=wire map=a b/c=d,e.png");
  EXPECT_EQ(values.get("mode")[0], 2);
  const std::vector<ImageValue> images = values.images();
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[0].parameter, "wood");
  EXPECT_EQ(images[0].file, "wood.png");
  EXPECT_TRUE(images[0].ofProgram);
  EXPECT_TRUE(images[0].sRgb);
  EXPECT_EQ(images[1].file, "a b/c=d,e.png");
  EXPECT_FALSE(images[1].ofProgram);
  EXPECT_FALSE(images[1].sRgb);
  values.set("wood", "");
  EXPECT_EQ(values.images()[0].file, "");
  EXPECT_FALSE(values.images()[0].ofProgram);
  EXPECT_THAT([&] { values.set("mode", "haet"); }, ThrowsMessage<UsageError>(hasWords({"'mode'", "'haet'", "'heat'"})));
  EXPECT_THAT([&] { values.set("mode", "1"); },
              ThrowsMessage<UsageError>(hasWords({"'mode'", "'1'", "plain, heat, wire"})));
  EXPECT_THAT([&] { values.set("count", "-1"); },
              ThrowsMessage<UsageError>(hasWords({"'count'", "-1", "0 to 4294967295"})));
  EXPECT_THAT([&] { values.set("count", "4294967296"); },
              ThrowsMessage<UsageError>(hasWords({"'count'", "4294967296", "0 to 4294967295"})));
}

TEST(Parameter, PacksTextureIndices) {
  const std::vector<std::uint32_t> textures = {7, 9};
  const std::vector<std::byte> bytes = ParameterValues(more()).pack(textures);
  std::array<std::uint32_t, 4> words{};
  ASSERT_EQ(bytes.size(), sizeof(words));
  std::memcpy(words.data(), bytes.data(), sizeof(words));
  EXPECT_EQ(words, (std::array<std::uint32_t, 4>{4294967295u, 7, 1, 9}));
  const std::vector<std::byte> without = ParameterValues(more()).pack();
  std::memcpy(words.data(), without.data(), sizeof(words));
  EXPECT_EQ(words[1], kNoParameterTexture);
}

TEST(Parameter, ReportsThatTheProgramHasNone) {
  ParameterValues none({});
  EXPECT_THAT([&] { none.set("a", "1"); }, ThrowsMessage<UsageError>(hasWords({"'a'", "no parameters"})));
}

TEST(Parameter, PacksAsScalarLayout) {
  const std::vector<std::byte> bytes = ParameterValues(kAll).pack();
  struct Block {
    std::uint32_t on;
    std::int32_t bounces;
    float clamp, size[2], up[3], box[4], tint[3];
  } block;
  ASSERT_EQ(bytes.size(), sizeof(Block));
  std::memcpy(&block, bytes.data(), sizeof(block));
  EXPECT_EQ(block.on, 1u);
  EXPECT_EQ(block.bounces, 12);
  EXPECT_EQ(block.clamp, 0.5f);
  EXPECT_EQ(block.size[1], 2.0f);
  EXPECT_EQ(block.up[1], 1.0f);
  EXPECT_EQ(block.box[3], 4.0f);
  EXPECT_EQ(block.tint[2], 0.25f);
  EXPECT_EQ(ParameterValues({}).pack().size(), 4u);  // a buffer cannot be empty
}

// ---- JSON ----

ParameterValues jsonValues() { return ParameterValues(parse(kParameters, parameterFiles()).parameters); }

// Matches an error of problem() at a JSON pointer or byte whose message contains all words.
auto isProblemAt(const std::string& location, const std::vector<std::string>& words) {
  return AllOf(StartsWith(location + ": "), hasWords(words));
}

// Returns the error of a JSON text as "/tint: problem"; empty if it has none.
std::string problem(const std::string& json) {
  ParameterValues v = jsonValues();
  const std::string before = v.describe();
  try {
    v.setFromJson(json, "folder/values.json");
  } catch (const FileError& error) {
    EXPECT_EQ(error.file(), "folder/values.json");
    EXPECT_EQ(v.describe(), before) << "an invalid file changes nothing";
    return error.location() + ": " + error.problem();
  }
  return {};
}

TEST(ParameterJson, SetsEveryType) {
  ParameterValues v = jsonValues();
  v.setFromJson(
      R"({"on": false, "bounces": 3.0, "count": 4294967295, "far": 2.5, "tint": [0, 0.125, 1], "mode": "plain", "wood": "a.png", "map": ""})",
      "folder/values.json");
  EXPECT_EQ(v.describe(),
            "on=false bounces=3 count=4294967295 far=2.5 tint=0,0.125,1 mode=plain wood=folder/a.png map=");
  v.setFromJson(R"({"wood": "/abs/b.png"})", "folder/values.json");
  EXPECT_EQ(v.images()[0].file, "/abs/b.png");
  v.setFromJson("{}", "x");
  EXPECT_EQ(v.get("bounces")[0], 3) << "values that the file does not name stay";
  v.setFromJson(R"({"bounces": 4, "bounces": 5})", "x");
  EXPECT_EQ(v.get("bounces")[0], 5);
}

TEST(ParameterJson, RoundTrips) {
  ParameterValues v = jsonValues();
  EXPECT_EQ(v.toJson(), R"({"on":true,"bounces":12,"count":3,"far":0.1,"tint":[1.0,0.5,0.25],"mode":"heat"})");
  v.set("far", "0.30000000000000004");
  v.set("mode", "plain");
  v.set("map", "x/y.png");
  ParameterValues other = jsonValues();
  other.setFromJson(v.toJson(), "values.json");
  EXPECT_EQ(other.toJson(), v.toJson());
  EXPECT_EQ(other.get("far")[0], 0.30000000000000004);
  EXPECT_EQ(other.images()[1].file, "x/y.png");
  EXPECT_TRUE(other.images()[0].ofProgram);
}

TEST(ParameterJson, ReportsTheLocationOfErrors) {
  EXPECT_THAT(problem(R"({"tnt": 1})"), isProblemAt("/tnt", {"'tnt'", "'tint'"}));
  EXPECT_EQ(problem(R"({"on": true, "a~b/c": 1})").substr(0, 10), "/a~0b~1c: ");
  EXPECT_THAT(problem(R"({"on": "true"})"), isProblemAt("/on", {"'on': 'true'", "a bool"}));
  EXPECT_THAT(problem(R"({"bounces": 1.5})"), isProblemAt("/bounces", {"'bounces': '1.5'", "an int"}));
  EXPECT_THAT(problem(R"({"bounces": true})"), isProblemAt("/bounces", {"'bounces': 'true'", "an int"}));
  EXPECT_THAT(problem(R"({"bounces": null})"), isProblemAt("/bounces", {"'bounces': 'null'", "an int"}));
  EXPECT_THAT(problem(R"({"bounces": 65})"), isProblemAt("/bounces", {"0 to 64"}));
  EXPECT_THAT(problem(R"({"far": -1})"), isProblemAt("/far", {"0 to 1e+30"}));
  EXPECT_THAT(problem(R"({"far": 1e300})"), isProblemAt("/far", {"0 to 1e+30"}));
  EXPECT_THAT(problem(R"({"tint": [1, 1]})"), isProblemAt("/tint", {"color", "3 numbers"}));
  EXPECT_THAT(problem(R"({"tint": [1, "1", 1]})"), isProblemAt("/tint", {"color", "3 numbers"}));
  EXPECT_THAT(problem(R"({"tint": {"r": 1}})"), isProblemAt("/tint", {"color", "3 numbers"}));
  EXPECT_THAT(problem(R"({"tint": [1, 1, 2]})"), isProblemAt("/tint", {"-1e+30 to 1"}));
  EXPECT_THAT(problem(R"({"mode": "haet"})"), isProblemAt("/mode", {"'haet'", "'heat'"}));
  EXPECT_THAT(problem(R"({"mode": 0})"), isProblemAt("/mode", {"'0'", "plain, heat"}));
  EXPECT_THAT(problem(R"({"wood": 3})"), isProblemAt("/wood", {"'3'", "image"}));
  EXPECT_THAT(problem("[1]"), isProblemAt("", {"object"}));
  EXPECT_THAT(problem("{\"on\": tru}"), isProblemAt("byte 11", {"JSON"}));
  EXPECT_THAT(problem(""), isProblemAt("byte 1", {"JSON"}));
  EXPECT_FALSE(problem("{\"far\": 1e999}").empty());
}

TEST(ParameterJson, RejectsDeepAndMalformedTexts) {
  const std::string deep(1u << 20, '[');
  EXPECT_FALSE(problem("{\"tint\": " + deep + "}").empty());
  EXPECT_FALSE(problem("{\"tint\": " + deep + std::string(deep.size(), ']') + "}").empty());
  EXPECT_FALSE(problem("{\"on\": \"\xff\xfe\"}").empty());
  EXPECT_FALSE(problem(std::string("{\"map\": \"a\\u0000b\"}")).empty());
}

}  // namespace
}  // namespace quintet::program
