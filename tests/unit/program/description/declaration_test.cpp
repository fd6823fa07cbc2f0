// SPDX-License-Identifier: Apache-2.0
// Declarations of parameters and shader records in program.toml, and values of records.
#include <gmock/gmock.h>

#include "program/description/parser.h"
#include "program/program_test_support.h"

namespace quintet::program {
namespace {

const std::string kRecord = R"([program]
ray_generation = "main.rgen"
callables = ["noise.rcall"]
record = { weight = 5 }

[[ray]]
name = "radiance"
miss = "sky.rmiss"
record = { tint = [0, 0, 1] }

[[ray]]
name = "shadow"
miss = "dark.rmiss"

[[miss]]
name = "other"
file = "sky.rmiss"
record = { on = true }

[[callable]]
name = "wood"
file = "noise.rcall"
record = { count = -3 }

[[hit_group]]
name = "a"
record = { tint = [1, 0, 0], weight = 2.5 }
radiance = { closest_hit = "hit.rchit", record = { tint = [0, 1, 0] } }
shadow = { any_hit = "alpha.rahit" }

[[hit_group]]
name = "b"
radiance = { closest_hit = "hit.rchit" }

[[record]]
name = "tint"
type = "color"
default = [1, 1, 1]
min = 0

[[record]]
name = "weight"
type = "float"
default = 1

[[record]]
name = "on"
type = "bool"
default = false

[[record]]
name = "count"
type = "int"
default = 7
)";

TEST(RecordValues, OverrideDefaultsPerGroupAndRayType) {
  const Program p = parse(kRecord);
  ASSERT_EQ(p.record.size(), 4u);
  EXPECT_EQ(p.record[3].type, ParameterType::integer);
  EXPECT_EQ(p.record[3].line, 51);
  using V = ParameterValue;
  const V white{1, 1, 1, 0};
  EXPECT_EQ(p.rayGenerationRecord, (RecordValues{white, V{5}, V{0}, V{7}}));
  EXPECT_EQ(p.rays[0].record, (RecordValues{V{0, 0, 1}, V{1}, V{0}, V{7}}));
  EXPECT_TRUE(p.rays[1].record.empty());
  EXPECT_EQ(p.misses[0].record, (RecordValues{white, V{1}, V{1}, V{7}}));
  EXPECT_TRUE(p.callables[0].record.empty());
  EXPECT_EQ(p.callables[1].record, (RecordValues{white, V{1}, V{0}, V{-3}}));
  EXPECT_EQ(p.hitGroups[0].shaders.at("radiance").record, (RecordValues{V{0, 1, 0}, V{2.5}, V{0}, V{7}}));
  EXPECT_EQ(p.hitGroups[0].shaders.at("shadow").record, (RecordValues{V{1, 0, 0}, V{2.5}, V{0}, V{7}}));
  EXPECT_TRUE(p.hitGroups[1].shaders.at("radiance").record.empty());
}

TEST(RecordValues, MustFitTheFields) {
  const auto error = [](const std::string& from, const std::string& to) { return errorOf(changed(kRecord, from, to)); };
  EXPECT_THAT(error("{ weight = 5 }", "{ wieght = 5 }"), isErrorAt(4, {"'wieght'", "'weight'"}));
  EXPECT_THAT(error("{ weight = 5 }", "{ zzzzzzzzz = 5 }"), isErrorAt(4, {"'zzzzzzzzz'", "tint, weight, on, count"}));
  EXPECT_THAT(error("{ weight = 5 }", "{ weight = \"5\" }"), isErrorAt(4, {"'weight'", "a number"}));
  EXPECT_THAT(error("{ weight = 5 }", "5"), isErrorAt(4, {"'record'"}));
  EXPECT_THAT(error("{ tint = [0, 0, 1] }", "{ tint = [0, 1] }"), isErrorAt(9, {"'tint'", "3 numbers"}));
  EXPECT_THAT(error("{ tint = [0, 0, 1] }", "{ tint = [0, -1, 1] }"), isErrorAt(9, {"'tint'", "0 to 1e+30"}));
  EXPECT_THAT(error("{ count = -3 }", "{ count = 0.5 }"), isErrorAt(23, {"'count'", "integer"}));
  EXPECT_THAT(error("{ count = -3 }", "{ count = 3000000000 }"),
              isErrorAt(23, {"'count'", "-2147483648 to 2147483647"}));
  EXPECT_THAT(error("{ on = true }", "{ on = 2 }"), isErrorAt(18, {"'on'", "0 to 1"}));
  EXPECT_THAT(error("{ on = true }", "{ on = \"yes\" }"), isErrorAt(18, {"'on'", "true or false"}));
  EXPECT_THAT(error("weight = 2.5 }", "weight = true }"), isErrorAt(27, {"'weight'", "a number"}));
  EXPECT_THAT(error("record = { tint = [0, 1, 0] } }", "record = { tnt = [0, 1, 0] } }"),
              isErrorAt(28, {"'tnt'", "'tint'"}));
  EXPECT_THAT(errorOf(changed(kSmall, "miss =", "record = { a = 1 }\nmiss =")), isErrorAt(7, {"[[record]]"}));
}

TEST(Declarations, OfRecordFieldsAreChecked) {
  EXPECT_THAT(errorOf(kSmall + "[[record]]\nname = \"a\"\ntype = \"float\"\n"), isErrorAt(8, {"'a'", "default"}));
  EXPECT_THAT(errorOf(kSmall + "[[record]]\nname = \"for\"\ntype = \"float\"\ndefault = 1\n"), isErrorAt(9, {"'for'"}));
}

TEST(Declarations, CannotHaveReservedNames) {
  const auto error = [](const std::string& name) {
    return errorOf(kSmall + "[[parameter]]\nname = \"" + name + "\"\ntype = \"float\"\ndefault = 1\n");
  };
  for (const char* name :
       {"for", "vec3", "dmat2x3", "uvec2", "sampler2DArrayShadow", "texture2D", "itextureBuffer", "uint", "int16_t",
        "frame", "parameters", "Address", "QT_CONSTANT", "shaderRecordEXT", "subpassInputMS"})
    EXPECT_THAT(error(name), isErrorAt(9, {std::string("'") + name + "'", "GLSL"}));
  for (const char* name : {"gl_x", "a__b", "2d", "", "a-b", "ä"})
    EXPECT_THAT(error(name), isErrorAt(9, {std::string("'") + name + "'", "identifier"}));
  for (const char* name : {"vec5", "texture0", "sampler1", "forward", "Frame", "mat", "record", "_"})
    EXPECT_EQ(error(name), "") << name;
}

std::string parameterError(const std::string& keys, const char* table = "parameter") {
  Files files = someFiles();
  files["wood.png"] = "";
  return errorOf(kSmall + "[[" + table + "]]\nname = \"a\"\n" + keys, files);  // `keys` start in line 10
}

TEST(Declarations, CanBeChoicesImagesAndUnsigned) {
  EXPECT_EQ(parameterError("type = \"choice\"\nchoices = [\"x\", \"y\"]\ndefault = \"y\"\n"), "");
  EXPECT_EQ(parameterError("type = \"image\"\ndefault = \"wood.png\"\nencoding = \"linear\"\n"), "");
  EXPECT_EQ(parameterError("type = \"image\"\ndefault = \"\"\n"), "");
  EXPECT_EQ(parameterError("type = \"uint\"\ndefault = 4294967295\n"), "");
  const Program p =
      parse(kSmall +
            "[[parameter]]\nname = \"mode\"\ntype = \"choice\"\nchoices = [\"plain\", \"heat\"]\ndefault = \"heat\"\n");
  EXPECT_EQ(p.parameters[0].defaultValue[0], 1);
}

TEST(Declarations, OfParametersAreChecked) {
  EXPECT_THAT(parameterError("type = \"choice\"\ndefault = \"y\"\n"), isErrorAt(8, {"[[parameter]]", "'choices'"}));
  EXPECT_THAT(parameterError("type = \"choice\"\nchoices = [\"x\", \"x\"]\ndefault = \"x\"\n"),
              isErrorAt(11, {"'x'", "duplicate"}));
  EXPECT_THAT(parameterError("type = \"choice\"\nchoices = [\"x y\"]\ndefault = \"x\"\n"),
              isErrorAt(11, {"'x y'", "identifier"}));
  EXPECT_THAT(parameterError("type = \"choice\"\nchoices = [\"plain\", \"heat\"]\ndefault = \"haet\"\n"),
              isErrorAt(12, {"'a'", "'haet'", "'heat'"}));
  EXPECT_THAT(parameterError("type = \"choice\"\nchoices = [\"x\"]\ndefault = 0\n"), isErrorAt(12, {"'a'"}));
  EXPECT_THAT(parameterError("type = \"image\"\ndefault = \"wod.png\"\n"), isErrorAt(11, {"'wod.png'", "'wood.png'"}));
  EXPECT_THAT(parameterError("type = \"image\"\ndefault = 3\n"), isErrorAt(11, {"'a'"}));
  EXPECT_THAT(parameterError("type = \"image\"\ndefault = \"\"\nencoding = \"gamma\"\n"),
              isErrorAt(12, {"'encoding'", "[[parameter]]", "'gamma'"}));
  EXPECT_THAT(parameterError("type = \"image\"\ndefault = \"\"\nmin = 0\n"), isErrorAt(12, {"[[parameter]]", "'min'"}));
  EXPECT_THAT(parameterError("type = \"uint\"\ndefault = -1\n"), isErrorAt(11, {"'a'", "0 to 4294967295"}));
  EXPECT_EQ(parameterError("type = \"int\"\ndefault = 1\nmin = -1e300\nmax = 1e300\n"), "");
  EXPECT_THAT(parameterError("type = \"int\"\ndefault = 1e299\nmin = -1e300\nmax = 1e300\n"),
              isErrorAt(11, {"'a'", "-2147483648 to 2147483647"}));
  EXPECT_THAT(parameterError("type = \"float\"\ndefault = nan\n"), isErrorAt(11, {"'a'", "-1e+30 to 1e+30"}));
  EXPECT_THAT(parameterError("type = \"image\"\ndefault = \"\"\n", "record"), isErrorAt(10, {"image"}));
}

TEST(Declarations, KeepTheirLines) {
  const Program p = parse(kRecord);
  EXPECT_EQ(p.descriptionFile, "program.toml");
  EXPECT_EQ(p.rayGenerationLine, 2);
  EXPECT_EQ(p.rays[0].line, 6);
  EXPECT_EQ(p.rays[1].line, 11);
  EXPECT_EQ(p.misses[0].line, 15);
  EXPECT_EQ(p.callables[0].line, 3);
  EXPECT_EQ(p.callables[1].line, 20);
  EXPECT_EQ(p.hitGroups[0].line, 25);
  EXPECT_EQ(p.hitGroups[0].shaders.at("radiance").line, 28);
  EXPECT_EQ(p.hitGroups[0].shaders.at("shadow").line, 29);
  EXPECT_EQ(p.record[0].line, 35);
  EXPECT_EQ(missShaders(p)[1].line, 11);
}

}  // namespace
}  // namespace quintet::program
