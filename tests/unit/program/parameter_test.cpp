// Parameters: what --set accepts, what it says otherwise, and the bytes that shaders read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "base/error.h"
#include "program/parameter.h"

namespace quintet::program {
namespace {

using testing::ThrowsMessage;

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

TEST(Parameter, StartsWithItsDefaultsAndIsSet) {
  ParameterValues values(kAll);
  EXPECT_EQ(values.describe(), "on=true bounces=12 clamp=0.5 size=1,2 up=0,1,0 box=1,2,3,4 tint=1,0.5,0.25");
  values.set("on", "false");
  values.set("bounces", "0");
  values.set("clamp", "1e1");  // the upper end is inside
  values.set("size", "-3,0.25");
  values.setAssignment("up=1,2,3");
  values.setAssignment("box=0,0,0,-1");
  EXPECT_EQ(values.describe(), "on=false bounces=0 clamp=10 size=-3,0.25 up=1,2,3 box=0,0,0,-1 tint=1,0.5,0.25");
  EXPECT_EQ(values.get("size"), (ParameterValue{-3, 0.25, 0, 0}));
  values.set("on", "1");
  EXPECT_EQ(values.get("on")[0], 1);
  EXPECT_THROW(values.get("none"), UsageError);
}

TEST(Parameter, SaysWhatIsWrong) {
  ParameterValues values(kAll);
  const auto message = [&](const std::string& name, const std::string& text) {
    try {
      values.set(name, text);
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message("bonces", "3"), "no parameter 'bonces'; did you mean 'bounces'?");
  EXPECT_EQ(message("qqqqqqqqqqqqqqq", "3"),
            "no parameter 'qqqqqqqqqqqqqqq'; there are: on, bounces, clamp, size, up, box, tint");
  EXPECT_EQ(message("bounces", "3.5"), "parameter 'bounces': '3.5' is not an int");
  EXPECT_EQ(message("bounces", "many"), "parameter 'bounces': 'many' is not an int");
  EXPECT_EQ(message("bounces", "true"), "parameter 'bounces': 'true' is not an int");
  EXPECT_EQ(message("bounces", ""), "parameter 'bounces': '' is not an int");
  EXPECT_EQ(message("bounces", "3 "), "parameter 'bounces': '3 ' is not an int");
  EXPECT_EQ(message("bounces", "-1"), "parameter 'bounces': -1 is outside 0 … 65536");
  EXPECT_EQ(message("clamp", "nan"), "parameter 'clamp': 'nan' is not a float");
  EXPECT_EQ(message("clamp", "inf"), "parameter 'clamp': 'inf' is not a float");
  EXPECT_EQ(message("clamp", "10.001"), "parameter 'clamp': 10.001 is outside 0 … 10");
  EXPECT_EQ(message("size", "1"), "parameter 'size': '1' is not a vec2 (2 numbers with commas)");
  EXPECT_EQ(message("size", "1,2,3"), "parameter 'size': '1,2,3' is not a vec2 (2 numbers with commas)");
  EXPECT_EQ(message("size", "1,"), "parameter 'size': '1,' is not a vec2 (2 numbers with commas)");
  EXPECT_EQ(message("tint", "0,0,2"), "parameter 'tint': 0,0,2 is outside 0 … 1");
  EXPECT_EQ(message("on", "2"), "parameter 'on': 2 is outside 0 … 1");
  EXPECT_THAT([&] { values.setAssignment("bounces"); },
              ThrowsMessage<UsageError>("'bounces' is not of the form name=value"));
  EXPECT_THAT([&] { values.setAssignment("=3"); }, ThrowsMessage<UsageError>("'=3' is not of the form name=value"));
  // Nothing was changed by all that.
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

TEST(Parameter, ChoicesAndImagesAreSetByText) {
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
  EXPECT_THAT([&] { values.set("mode", "haet"); },
              ThrowsMessage<UsageError>("parameter 'mode': there is no choice 'haet'; did you mean 'heat'?"));
  EXPECT_THAT([&] { values.set("mode", "1"); },
              ThrowsMessage<UsageError>("parameter 'mode': there is no choice '1'; there are: plain, heat, wire"));
  EXPECT_THAT([&] { values.set("count", "-1"); },
              ThrowsMessage<UsageError>("parameter 'count': -1 is outside 0 … 4294967295"));
  EXPECT_THAT([&] { values.set("count", "4294967296"); },
              ThrowsMessage<UsageError>("parameter 'count': 4294967296 is outside 0 … 4294967295"));
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

TEST(Parameter, SaysThatThereIsNone) {
  ParameterValues none({});
  EXPECT_THAT([&] { none.set("a", "1"); }, ThrowsMessage<UsageError>("no parameter 'a'; the program has none"));
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
  EXPECT_EQ(ParameterValues({}).pack().size(), 4u);  // a buffer needs some bytes
}

TEST(Parameter, FindsTheNearestName) {
  const std::vector<std::string> names = {"bounces", "roulette_start", "clamp"};
  EXPECT_EQ(nearestName("bounce", names), "bounces");
  EXPECT_EQ(nearestName("rouletestart", names), "roulette_start");
  EXPECT_EQ(nearestName("clamp", names), "clamp");
  EXPECT_EQ(nearestName("CLAMP", names), "");
  EXPECT_EQ(nearestName("exposure_compensation", names), "");
  EXPECT_EQ(nearestName("x", {}), "");
}

}  // namespace
}  // namespace quintet::program
