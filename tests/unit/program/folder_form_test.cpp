// The rest of program.toml: further miss shaders, callables, shader records, kinds of outputs, and the lines that
// diagnostics point to.
#include <gmock/gmock.h>

#include "program/generated.h"
#include "program_test_support.h"

namespace quintet::program {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kSmallText = kSmall;

TEST(FolderForm, MissShadersFollowThoseOfTheRays) {
  const Program p = parse(kSmallText + R"([[ray]]
name = "shadow"
miss = "dark.rmiss"
[[miss]]
name = "black"
file = "dark.rmiss"
[[miss]]
name = "library"
file = "<quintet/stages/shadow.rmiss>"
)");
  ASSERT_EQ(p.misses.size(), 2u);
  EXPECT_EQ(p.misses[0].line, 11);
  const std::vector<MissShader> all = missShaders(p);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[1].file, "dark.rmiss");
  EXPECT_EQ(all[3].file, "<quintet/stages/shadow.rmiss>");
  const std::string glsl = generatedConstants(p);
  for (const char* line :
       {"const uint kMissCount = 4u;", "const uint kMiss_radiance = 0u;", "const uint kMiss_shadow = 1u;",
        "const uint kMiss_black = 2u;", "const uint kMiss_library = 3u;", "const uint kRayTypeCount = 2u;"})
    EXPECT_THAT(glsl, HasSubstr(line));
}

TEST(FolderForm, WrongMissShadersAreRefused) {
  EXPECT_EQ(errorOf(kSmallText + "[[miss]]\nname = \"radiance\"\nfile = \"dark.rmiss\"\n"),
            "line 9: 'radiance' is there twice");
  EXPECT_EQ(errorOf(kSmallText + "[[miss]]\nname = \"a\"\n"), "line 8: [[miss]] needs 'file'");
  EXPECT_EQ(errorOf(kSmallText + "[[miss]]\nname = \"a\"\nfile = \"dark.rmis\"\n"),
            "line 10: 'dark.rmis' must end in .rmiss");
  EXPECT_EQ(errorOf(kSmallText + "[[miss]]\nname = \"a\"\nfile = \"drak.rmiss\"\n"),
            "line 10: there is no file 'drak.rmiss' in folder/demo; did you mean 'dark.rmiss'?");
  EXPECT_EQ(errorOf(kSmallText + "[[miss]]\nname = \"a\"\nmiss = \"dark.rmiss\"\nfile = \"dark.rmiss\"\n"),
            "line 10: [[miss]] has no key 'miss'");
}

TEST(FolderForm, CallablesHaveNamesInBothForms) {
  Files files = someFiles();
  files["2d noise.rcall"] = "";
  const Program p = parse(changed(kSmallText, "description",
                                  "callables = [\"noise.rcall\", \"2d noise.rcall\", \"noise.rcall\"]\ndescription") +
                              "[[callable]]\nname = \"wood\"\nfile = \"noise.rcall\"\n",
                          files);
  ASSERT_EQ(p.callables.size(), 4u);
  EXPECT_EQ(p.callables[0].name, "noise");
  EXPECT_EQ(p.callables[1].name, "") << "no identifier";
  EXPECT_EQ(p.callables[2].name, "") << "the name is taken";
  EXPECT_EQ(p.callables[3].name, "wood");
  EXPECT_EQ(p.callables[0].line, 3);
  EXPECT_EQ(p.callables[3].line, 9);
  const std::string glsl = generatedConstants(p);
  EXPECT_THAT(glsl, HasSubstr("const uint kCallable_noise = 0u;"));
  EXPECT_THAT(glsl, HasSubstr("const uint kCallable_wood = 3u;"));
  EXPECT_THAT(glsl, HasSubstr("const uint kCallableCount = 4u;"));
  EXPECT_THAT(glsl, Not(HasSubstr("kCallable_ ")));
}

TEST(FolderForm, OutputsHaveKindAndHelp) {
  const Program p = parse(kSmallText + R"([[output]]
name = "color"
[[output]]
name = "far"
kind = "depth"
help = "along the ray"
[[output]]
name = "other"
)");
  EXPECT_EQ(p.outputs[0].kind, OutputKind::color);
  EXPECT_EQ(p.outputs[1].kind, OutputKind::depth);
  EXPECT_EQ(p.outputs[1].help, "along the ray");
  EXPECT_EQ(p.outputs[1].line, 10);
  EXPECT_EQ(p.outputs[2].kind, OutputKind::linear);
  EXPECT_THAT(generatedConstants(p), HasSubstr("const uint kOutputCount = 3u;"));
  EXPECT_EQ(errorOf(kSmallText + "[[output]]\nname = \"a\"\nkind = \"depht\"\n"),
            "line 10: 'kind' of [[output]] cannot be 'depht'; did you mean 'depth'?");
  EXPECT_EQ(
      errorOf(kSmallText + "[[output]]\nname = \"a\"\nkind = \"motion vectors\"\n"),
      "line 10: 'kind' of [[output]] cannot be 'motion vectors'; there are color, linear, normal, depth, id, display");
}

TEST(FolderForm, ReadsHowSamplesAndInstancesAreTreated) {
  const Program p =
      parse(changed(kSmallText, "description", "accumulation = \"program\"\nkeeps_instance_order = true\ndescription"));
  EXPECT_EQ(p.accumulation, Accumulation::program);
  EXPECT_TRUE(p.keepsInstanceOrder);
  EXPECT_EQ(errorOf(changed(kSmallText, "description", "accumulation = \"fim\"\ndescription")),
            "line 3: 'accumulation' of [program] cannot be 'fim'; did you mean 'film'?");
  EXPECT_EQ(errorOf(changed(kSmallText, "description", "keeps_instance_order = 1\ndescription")),
            "line 3: 'keeps_instance_order' of [program] must be true or false");
}

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

TEST(ShaderRecord, ValuesOverrideDefaultsStepByStep) {
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

TEST(ShaderRecord, IsDeclaredInGlsl) {
  const std::string glsl = generatedRecord(parse(kRecord));
  EXPECT_THAT(glsl, HasSubstr("struct Record {\n  vec3 tint;\n  float weight;\n  uint on;\n  int count;\n};"));
  EXPECT_THAT(glsl, HasSubstr("layout(shaderRecordEXT, scalar) buffer RecordBlock { Record record; };"));
  EXPECT_THAT(generatedRecord(parse(kSmall)), HasSubstr("#error"));
}

TEST(ShaderRecord, WrongValuesAreRefused) {
  const auto error = [](const std::string& from, const std::string& to) { return errorOf(changed(kRecord, from, to)); };
  EXPECT_EQ(error("{ weight = 5 }", "{ wieght = 5 }"),
            "line 4: the record has no field 'wieght'; did you mean 'weight'?");
  EXPECT_EQ(error("{ weight = 5 }", "{ zzzzzzzzz = 5 }"),
            "line 4: the record has no field 'zzzzzzzzz'; there are tint, weight, on, count");
  EXPECT_EQ(error("{ weight = 5 }", "{ weight = \"5\" }"), "line 4: the record's 'weight' must be a number");
  EXPECT_EQ(error("{ weight = 5 }", "5"), "line 4: 'record' must be a table such as { tint = [1.0, 0.5, 0.0] }");
  EXPECT_EQ(error("{ tint = [0, 0, 1] }", "{ tint = [0, 1] }"), "line 9: the record's 'tint' needs 3 numbers");
  EXPECT_EQ(error("{ tint = [0, 0, 1] }", "{ tint = [0, -1, 1] }"), "line 9: the record's 'tint' is outside 0 … 1e+30");
  EXPECT_EQ(error("{ count = -3 }", "{ count = 0.5 }"), "line 23: the record's 'count' must be a whole number");
  EXPECT_EQ(error("{ count = -3 }", "{ count = 3000000000 }"),
            "line 23: the record's 'count' is outside -2147483648 … 2147483647");
  EXPECT_EQ(error("{ on = true }", "{ on = 2 }"), "line 18: the record's 'on' is outside 0 … 1");
  EXPECT_EQ(error("{ on = true }", "{ on = \"yes\" }"), "line 18: the record's 'on' must be true or false");
  EXPECT_EQ(error("weight = 2.5 }", "weight = true }"), "line 27: the record's 'weight' must be a number");
  EXPECT_EQ(error("record = { tint = [0, 1, 0] } }", "record = { tnt = [0, 1, 0] } }"),
            "line 28: the record has no field 'tnt'; did you mean 'tint'?");
  EXPECT_EQ(errorOf(changed(kSmallText, "miss =", "record = { a = 1 }\nmiss =")),
            "line 7: the program declares no [[record]]");
}

TEST(ShaderRecord, WrongFieldsAreRefused) {
  EXPECT_EQ(errorOf(kSmallText + "[[record]]\nname = \"a\"\ntype = \"float\"\n"), "line 8: field 'a' needs a default");
  EXPECT_EQ(errorOf(kSmallText + "[[record]]\nname = \"for\"\ntype = \"float\"\ndefault = 1\n"),
            "line 9: 'for' is a word of GLSL or of the shader library");
}

TEST(FolderForm, NamesOfParametersAreNotWordsOfGlsl) {
  const auto error = [](const std::string& name) {
    return errorOf(kSmallText + "[[parameter]]\nname = \"" + name + "\"\ntype = \"float\"\ndefault = 1\n");
  };
  for (const char* name :
       {"for", "vec3", "dmat2x3", "uvec2", "sampler2DArrayShadow", "texture2D", "itextureBuffer", "uint", "int16_t",
        "frame", "parameters", "Address", "QT_CONSTANT", "shaderRecordEXT", "subpassInputMS"})
    EXPECT_EQ(error(name), std::string("line 9: '") + name + "' is a word of GLSL or of the shader library");
  for (const char* name : {"gl_x", "a__b", "2d", "", "a-b", "ä"})
    EXPECT_EQ(error(name), std::string("line 9: '") + name + "' is not an identifier");
  for (const char* name : {"vec5", "texture0", "sampler1", "forward", "Frame", "mat", "record", "_"})
    EXPECT_EQ(error(name), "") << name;
}

std::string parameterError(const std::string& keys, const char* table = "parameter") {
  Files files = someFiles();
  files["wood.png"] = "";
  return errorOf(kSmallText + "[[" + table + "]]\nname = \"a\"\n" + keys, files);  // `keys` from line 10 on
}

TEST(FolderForm, ParametersCanBeChoicesImagesAndUnsigned) {
  EXPECT_EQ(parameterError("type = \"choice\"\nchoices = [\"x\", \"y\"]\ndefault = \"y\"\n"), "");
  EXPECT_EQ(parameterError("type = \"image\"\ndefault = \"wood.png\"\nencoding = \"linear\"\n"), "");
  EXPECT_EQ(parameterError("type = \"image\"\ndefault = \"\"\n"), "");
  EXPECT_EQ(parameterError("type = \"uint\"\ndefault = 4294967295\n"), "");
  const Program p =
      parse(kSmallText +
            "[[parameter]]\nname = \"mode\"\ntype = \"choice\"\nchoices = [\"plain\", \"heat\"]\ndefault = \"heat\"\n");
  EXPECT_EQ(p.parameters[0].defaultValue[0], 1);
  EXPECT_THAT(generatedConstants(p),
              HasSubstr("const uint kChoice_mode_plain = 0u;\nconst uint kChoice_mode_heat = 1u;\n"));
  EXPECT_THAT(generatedConstants(p), HasSubstr("  uint mode;\n"));
}

TEST(FolderForm, WrongParametersAreRefused) {
  EXPECT_EQ(parameterError("type = \"choice\"\ndefault = \"y\"\n"), "line 8: [[parameter]] needs 'choices'");
  EXPECT_EQ(parameterError("type = \"choice\"\nchoices = [\"x\", \"x\"]\ndefault = \"x\"\n"),
            "line 11: the choice 'x' is there twice");
  EXPECT_EQ(parameterError("type = \"choice\"\nchoices = [\"x y\"]\ndefault = \"x\"\n"),
            "line 11: the choice 'x y' is not an identifier");
  EXPECT_EQ(parameterError("type = \"choice\"\nchoices = [\"plain\", \"heat\"]\ndefault = \"haet\"\n"),
            "line 12: the default of 'a' cannot be 'haet'; did you mean 'heat'?");
  EXPECT_EQ(parameterError("type = \"choice\"\nchoices = [\"x\"]\ndefault = 0\n"),
            "line 12: the default of 'a' must be one of x");
  EXPECT_EQ(parameterError("type = \"image\"\ndefault = \"wod.png\"\n"),
            "line 11: there is no file 'wod.png' beside program.toml; did you mean 'wood.png'?");
  EXPECT_EQ(parameterError("type = \"image\"\ndefault = 3\n"),
            "line 11: the default of 'a' must be the name of a file, or \"\"");
  EXPECT_EQ(parameterError("type = \"image\"\ndefault = \"\"\nencoding = \"gamma\"\n"),
            "line 12: 'encoding' of [[parameter]] cannot be 'gamma'; there are srgb, linear");
  EXPECT_EQ(parameterError("type = \"image\"\ndefault = \"\"\nmin = 0\n"), "line 12: [[parameter]] has no key 'min'");
  EXPECT_EQ(parameterError("type = \"uint\"\ndefault = -1\n"), "line 11: the default of 'a' is outside 0 … 4294967295");
  EXPECT_EQ(parameterError("type = \"int\"\ndefault = 1\nmin = -1e300\nmax = 1e300\n"), "");
  EXPECT_EQ(parameterError("type = \"int\"\ndefault = 1e299\nmin = -1e300\nmax = 1e300\n"),
            "line 11: the default of 'a' is outside -2147483648 … 2147483647");
  EXPECT_EQ(parameterError("type = \"float\"\ndefault = nan\n"),
            "line 11: the default of 'a' is outside -1e+30 … 1e+30");
  EXPECT_EQ(parameterError("type = \"image\"\ndefault = \"\"\n", "record"),
            "line 10: a field cannot be an image: declare a parameter");
}

TEST(FolderForm, KeepsTheLines) {
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
