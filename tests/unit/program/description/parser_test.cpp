// SPDX-License-Identifier: Apache-2.0
// program.toml: what the parser reads, and the line and key of every error.
#include "program/description/parser.h"

#include <gmock/gmock.h>

#include <ostream>

#include "program/program_test_support.h"

namespace quintet::program {
namespace {

const std::string kFull = R"([program]
description = "every table"
ray_generation = "main.rgen"
max_recursion = 3
samples_per_launch = 16
callables = ["noise.rcall"]

[[ray]]
name = "radiance"
miss = "sky.rmiss"

[[ray]]
name = "shadow"
miss = "<quintet/stages/shadow.rmiss>"

[[hit_group]]
name = "solid"
geometry = "opaque"
radiance = { closest_hit = "hit.rchit" }

[[hit_group]]
name = "boxes"
geometry = "alpha"
radiance = { closest_hit = "<quintet/stages/surface.rchit>", any_hit = "alpha.rahit", intersection = "box.rint" }
shadow = { any_hit = "alpha.rahit" }

[[output]]
name = "color"

[[output]]
name = "depth"

[[parameter]]
name = "tint"
type = "color"
default = [0.5, 1, 0.25]
min = 0
max = 2.0
unit = "W"
help = "a color"
)";

TEST(ProgramToml, ReadsAllTables) {
  const Program p = parse(kFull);
  EXPECT_EQ(p.name, "demo");
  EXPECT_EQ(p.origin, "folder/demo");
  EXPECT_EQ(p.description, "every table");
  EXPECT_EQ(p.rayGeneration, "main.rgen");
  EXPECT_EQ(p.declaredRecursion, 3u);
  EXPECT_EQ(p.samplesPerLaunch, 16u);
  ASSERT_EQ(p.callables.size(), 1u);
  EXPECT_EQ(p.callables[0].file, "noise.rcall");
  EXPECT_EQ(p.callables[0].name, "noise");
  ASSERT_EQ(p.rays.size(), 2u);
  EXPECT_EQ(p.rays[0].name, "radiance");
  EXPECT_EQ(p.rays[1].miss, "<quintet/stages/shadow.rmiss>");
  ASSERT_EQ(p.hitGroups.size(), 2u);
  EXPECT_EQ(p.hitGroups[0].geometry, std::vector<std::string>{"opaque"});
  EXPECT_EQ(p.hitGroups[0].shaders.at("radiance").closestHit, "hit.rchit");
  EXPECT_EQ(p.hitGroups[0].shaders.count("shadow"), 0u);
  EXPECT_EQ(p.hitGroups[1].shaders.at("radiance").intersection, "box.rint");
  EXPECT_EQ(p.hitGroups[1].shaders.at("shadow").anyHit, "alpha.rahit");
  EXPECT_EQ(outputNames(p), (std::vector<std::string>{"color", "depth"}));
  ASSERT_EQ(p.parameters.size(), 1u);
  const Parameter& tint = p.parameters[0];
  EXPECT_EQ(tint.type, ParameterType::color);
  EXPECT_EQ(tint.defaultValue, (ParameterValue{0.5, 1, 0.25, 0}));
  EXPECT_EQ(tint.min, 0);
  EXPECT_EQ(tint.max, 2);
  EXPECT_EQ(tint.unit, "W");
  EXPECT_EQ(tint.help, "a color");
}

TEST(ProgramToml, FillsInDefaults) {
  const Program p = parse(kSmall);
  EXPECT_FALSE(p.declaredRecursion.has_value());
  EXPECT_EQ(p.accumulation, Accumulation::film);
  EXPECT_FALSE(p.keepsInstanceOrder);
  EXPECT_FALSE(p.mergesInstances);
  EXPECT_EQ(p.samplesPerLaunch, 1u);
  EXPECT_EQ(outputNames(p), std::vector<std::string>{"color"});
  EXPECT_TRUE(p.hitGroups.empty());
  EXPECT_TRUE(p.parameters.empty());
}

TEST(ProgramToml, DerivesChannelsFromTheKind) {
  using Names = std::vector<std::string>;
  const auto output = [](const std::string& keys) {
    return parse(kSmall + "\n[[output]]\nname = \"a\"\n" + keys + "\n").outputs.at(0);
  };
  EXPECT_EQ(outputChannels(output("kind = \"color\"")), (Names{"R", "G", "B"}));
  EXPECT_TRUE(holdsColor(output("kind = \"color\"")));
  EXPECT_EQ(outputChannels(output("kind = \"linear\"")), (Names{"X", "Y", "Z"}));
  EXPECT_EQ(outputChannels(output("kind = \"normal\"")), (Names{"X", "Y", "Z"}));
  EXPECT_EQ(outputChannels(output("kind = \"depth\"")), (Names{"Z"}));
  EXPECT_EQ(outputChannels(output("kind = \"id\"")), (Names{"X"}));
  EXPECT_FALSE(holdsColor(output("kind = \"id\"")));
  const Output listed = output("channels = [\"R\", \"G\", \"B\", \"A\"]");
  EXPECT_EQ(outputChannels(listed), (Names{"R", "G", "B", "A"}));
  EXPECT_TRUE(holdsColor(listed));
  EXPECT_FALSE(holdsColor(output("channels = [\"R\", \"G\"]")));
}

TEST(ProgramToml, RecognizesLibraryStages) {
  EXPECT_TRUE(isLibraryStage("<quintet/stages/surface.rchit>"));
  EXPECT_FALSE(isLibraryStage("surface.rchit"));
  EXPECT_FALSE(isLibraryStage("<>"));
  EXPECT_FALSE(isLibraryStage(""));
  const Program p = parse(kFull);
  EXPECT_EQ(p.path("main.rgen"), "folder/demo/main.rgen");
  EXPECT_EQ(p.path("<quintet/stages/shadow.rmiss>"), "<quintet/stages/shadow.rmiss>");
}

struct WrongCase {
  const char* name;
  std::string from;  // in kFull
  std::string to;
  int line;
  std::vector<std::string> words;  // that the message contains
};

void PrintTo(const WrongCase& c, std::ostream* out) { *out << c.to; }

class ProgramErrors : public testing::TestWithParam<WrongCase> {};

TEST_P(ProgramErrors, NameTheLineAndTheKey) {
  const WrongCase& c = GetParam();
  EXPECT_THAT(errorOf(changed(kFull, c.from, c.to)), isErrorAt(c.line, c.words));
}

const WrongCase kWrong[] = {
    {"UnknownKeyOfProgram", "max_recursion", "max_recursoin", 4, {"[program]", "'max_recursoin'", "'max_recursion'"}},
    {"UnknownKeyOfRay", "miss = \"sky.rmiss\"", "miss = \"sky.rmiss\"\nmis = 1", 11, {"[[ray]]", "'mis'", "'miss'"}},
    {"UnknownKeyWithoutHint", "unit", "zzzzzzzzzzzzzzzz", 39, {"[[parameter]]", "'zzzzzzzzzzzzzzzz'"}},
    {"UnknownKeyAtTheTop", "[[output]]", "[[outputs]]", 27, {"'outputs'", "'output'"}},
    {"UnknownStage",
     "{ closest_hit",
     "{ closes_hit",
     19,
     {"'radiance'", "[[hit_group]]", "'closes_hit'", "'closest_hit'"}},
    {"UnknownRay", "shadow = {", "shadows = {", 25, {"[[hit_group]]", "'shadows'", "'shadow'"}},
    {"UnknownKeyOfOutput", "name = \"depth\"", "name = \"depth\"\ntype = 1", 32, {"[[output]]", "'type'"}},
    {"ChannelTwice", "name = \"depth\"", "name = \"depth\"\nchannels = [\"X\", \"X\"]", 32, {"'channels'"}},
    {"ChannelWithDot", "name = \"depth\"", "name = \"depth\"\nchannels = \"a.R\"", 32, {"'channels'"}},
    {"TooManyChannels",
     "name = \"depth\"",
     "name = \"depth\"\nchannels = [\"A\", \"B\", \"C\", \"D\", \"E\"]",
     32,
     {"'channels'"}},
    {"MissingFile", "main.rgen", "mian.rgen", 3, {"'mian.rgen'", "'main.rgen'", "folder/demo"}},
    {"MissingCallable", "noise.rcall", "none.rcall", 6, {"'none.rcall'", "'noise.rcall'"}},
    {"WrongExtension", "closest_hit = \"hit.rchit\"", "closest_hit = \"alpha.rahit\"", 19, {"'alpha.rahit'", ".rchit"}},
    {"WrongLibraryExtension", "shadow.rmiss", "surface.rchit", 14, {"'<quintet/stages/surface.rchit>'", ".rmiss"}},
    {"DuplicateRay", "name = \"shadow\"", "name = \"radiance\"", 13, {"'radiance'", "duplicate"}},
    {"DuplicateHitGroup", "name = \"boxes\"", "name = \"solid\"", 22, {"'solid'", "duplicate"}},
    {"DuplicateOutput", "name = \"depth\"", "name = \"color\"", 31, {"'color'", "duplicate"}},
    {"NoIdentifier", "name = \"depth\"", "name = \"depth of field\"", 31, {"'depth of field'", "identifier"}},
    {"ReservedName", "name = \"tint\"", "name = \"gl_Tint\"", 34, {"'gl_Tint'", "identifier"}},
    {"DigitFirst", "name = \"tint\"", "name = \"2tint\"", 34, {"'2tint'", "identifier"}},
    {"UnknownType", "type = \"color\"", "type = \"colr\"", 35, {"'colr'", "'color'"}},
    {"TypeFarFromAny",
     "type = \"color\"",
     "type = \"polynomial\"",
     35,
     {"'polynomial'", "bool, int, float, vec2, vec3, vec4, color, uint, choice, image"}},
    {"DefaultTooShort", "[0.5, 1, 0.25]", "[0.5, 1]", 36, {"'tint'", "3 numbers"}},
    {"DefaultNoList", "[0.5, 1, 0.25]", "0.5", 36, {"'tint'", "3 numbers"}},
    {"DefaultNoScalar", "type = \"color\"", "type = \"float\"", 36, {"'tint'", "requires 1 number"}},
    {"DefaultOutside", "0.25]", "3]", 36, {"'tint'", "0 to 2"}},
    {"DefaultNoNumber", "0.25]", "\"x\"]", 36, {"'tint'", "a number"}},
    {"RecursionTooDeep", "max_recursion = 3", "max_recursion = 32", 4, {"'max_recursion'", "[program]", "1 to 31"}},
    {"CountNoInteger",
     "samples_per_launch = 16",
     "samples_per_launch = 1.5",
     5,
     {"'samples_per_launch'", "[program]", "1 to 4096"}},
    {"TextNoString", "description = \"every table\"", "description = 3", 2, {"'description'", "[program]", "string"}},
    {"CallablesNoList", "[\"noise.rcall\"]", "\"noise.rcall\"", 6, {"'callables'"}},
    {"CallablesNoNames", "[\"noise.rcall\"]", "[1]", 6, {"'callables'"}},
    {"StagesNoTable", "{ closest_hit = \"hit.rchit\" }", "\"hit.rchit\"", 19, {"'radiance'"}},
};

INSTANTIATE_TEST_SUITE_P(Each, ProgramErrors, testing::ValuesIn(kWrong),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(ProgramToml, RequiresKeys) {
  EXPECT_THAT(errorOf("x = 1\n"), isErrorAt(1, {"[program]"}));
  EXPECT_THAT(errorOf(changed(kSmall, "ray_generation = \"main.rgen\"\n", "")),
              isErrorAt(1, {"[program]", "'ray_generation'"}));
  EXPECT_THAT(errorOf(changed(kSmall, "miss = \"sky.rmiss\"", "")), isErrorAt(5, {"[[ray]]", "'miss'"}));
  EXPECT_THAT(errorOf(changed(kSmall, "name = \"radiance\"", "")), isErrorAt(5, {"[[ray]]", "'name'"}));
  EXPECT_THAT(errorOf("[program]\nray_generation = \"main.rgen\"\n"), isErrorAt(1, {"[[ray]]"}));
  EXPECT_THAT(errorOf(kSmall + "[[parameter]]\nname = \"a\"\ntype = \"int\"\n"), isErrorAt(8, {"'a'"}));
  EXPECT_THAT(errorOf(kSmall + "[[parameter]]\nname = \"a\"\n"), isErrorAt(8, {"[[parameter]]", "'type'"}));
  EXPECT_THAT(errorOf(kSmall + "[output]\nname = \"a\"\n"), isErrorAt(8, {"'output'", "[[output]]"}));
}

TEST(ProgramToml, ReportsSyntaxErrors) {
  const std::string error = errorOf("[program]\nray_generation = \"main.rgen\nmax_recursion = 3\n");
  EXPECT_TRUE(error.starts_with("line 2: ")) << error;
  EXPECT_FALSE(errorOf("[program]\n[program]\n").empty());
  EXPECT_FALSE(errorOf(std::string("a = \"\0\"", 7)).empty());
}

TEST(ProgramToml, AcceptsAtMostFifteenRayTypes) {
  std::string toml = kSmall;
  const auto ray = [](int i) { return "[[ray]]\nname = \"r" + std::to_string(i) + "\"\nmiss = \"sky.rmiss\"\n"; };
  for (int i = 1; i < 15; ++i) toml += ray(i);
  EXPECT_EQ(parse(toml).rays.size(), 15u);
  EXPECT_THAT(errorOf(toml + ray(15)), isErrorAt(50, {"15 ray types"}));
}

TEST(ProgramToml, AppendsMissShadersToThoseOfTheRays) {
  const Program p = parse(kSmall + R"([[ray]]
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
}

TEST(ProgramToml, RejectsInvalidMissShaders) {
  EXPECT_THAT(errorOf(kSmall + "[[miss]]\nname = \"radiance\"\nfile = \"dark.rmiss\"\n"), isErrorAt(9, {"'radiance'"}));
  EXPECT_THAT(errorOf(kSmall + "[[miss]]\nname = \"a\"\n"), isErrorAt(8, {"[[miss]]", "'file'"}));
  EXPECT_THAT(errorOf(kSmall + "[[miss]]\nname = \"a\"\nfile = \"dark.rmis\"\n"), isErrorAt(10, {"'dark.rmis'"}));
  EXPECT_THAT(errorOf(kSmall + "[[miss]]\nname = \"a\"\nfile = \"drak.rmiss\"\n"),
              isErrorAt(10, {"'drak.rmiss'", "'dark.rmiss'"}));
  EXPECT_THAT(errorOf(kSmall + "[[miss]]\nname = \"a\"\nmiss = \"dark.rmiss\"\nfile = \"dark.rmiss\"\n"),
              isErrorAt(10, {"[[miss]]", "'miss'"}));
}

TEST(ProgramToml, NamesCallablesInBothForms) {
  Files files = someFiles();
  files["2d noise.rcall"] = "";
  const Program p = parse(changed(kSmall, "description",
                                  "callables = [\"noise.rcall\", \"2d noise.rcall\", \"noise.rcall\"]\ndescription") +
                              "[[callable]]\nname = \"wood\"\nfile = \"noise.rcall\"\n",
                          files);
  ASSERT_EQ(p.callables.size(), 4u);
  EXPECT_EQ(p.callables[0].name, "noise");
  EXPECT_EQ(p.callables[1].name, "") << "not an identifier";
  EXPECT_EQ(p.callables[2].name, "") << "the name is taken";
  EXPECT_EQ(p.callables[3].name, "wood");
  EXPECT_EQ(p.callables[0].line, 3);
  EXPECT_EQ(p.callables[3].line, 9);
}

TEST(ProgramToml, ReadsOutputs) {
  const Program p = parse(kSmall + R"([[output]]
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
  EXPECT_THAT(errorOf(kSmall + "[[output]]\nname = \"a\"\nkind = \"depht\"\n"),
              isErrorAt(10, {"'kind'", "[[output]]", "'depht'", "'depth'"}));
  EXPECT_THAT(errorOf(kSmall + "[[output]]\nname = \"a\"\nkind = \"motion vectors\"\n"),
              isErrorAt(10, {"'motion vectors'", "color, linear, normal, depth, id, display"}));
}

TEST(ProgramToml, ReadsAccumulationAndInstanceOrder) {
  const Program p =
      parse(changed(kSmall, "description",
                    "accumulation = \"program\"\nkeeps_instance_order = true\nmerges_instances = true\ndescription"));
  EXPECT_EQ(p.accumulation, Accumulation::program);
  EXPECT_TRUE(p.keepsInstanceOrder);
  EXPECT_TRUE(p.mergesInstances);
  EXPECT_THAT(errorOf(changed(kSmall, "description", "accumulation = \"fim\"\ndescription")),
              isErrorAt(3, {"'accumulation'", "[program]", "'fim'", "'film'"}));
  EXPECT_THAT(errorOf(changed(kSmall, "description", "keeps_instance_order = 1\ndescription")),
              isErrorAt(3, {"'keeps_instance_order'", "[program]"}));
}

const std::string kGroup = kSmall + "\n[[hit_group]]\nname = \"g\"\n";  // its keys start in line 11

TEST(ProgramToml, ReadsBindingsAsANameOrAList) {
  const Program p =
      parse(kGroup + "geometry = [\"csg\", \"custom\"]\nmaterial = [\"glass\", \"ice\"]\nprimitives = \"balls\"\n");
  ASSERT_EQ(p.hitGroups.size(), 1u);
  EXPECT_EQ(p.hitGroups[0].geometry, (std::vector<std::string>{"csg", "custom"}));
  EXPECT_EQ(p.hitGroups[0].material, (std::vector<std::string>{"glass", "ice"}));
  EXPECT_EQ(p.hitGroups[0].primitives, std::vector<std::string>{"balls"});
}

TEST(ProgramToml, RejectsInvalidBindings) {
  EXPECT_THAT(errorOf(kGroup + "geometry = \"triangle\"\n"), isErrorAt(11, {"'triangle'", "'triangles'"}));
  EXPECT_THAT(errorOf(kGroup + "geometry = \"zzzzzzzzzzzzzzz\"\n"),
              isErrorAt(11, {"'zzzzzzzzzzzzzzz'", "triangles, solids, csg, custom, procedural, opaque, alpha, thin"}));
  EXPECT_THAT(errorOf(kGroup + "material = 3\n"), isErrorAt(11, {"'material'", "[[hit_group]]"}));
  EXPECT_THAT(errorOf(kGroup + "material = [\"a\", 3]\n"), isErrorAt(11, {"'material'", "[[hit_group]]"}));
  EXPECT_THAT(errorOf(kGroup + "primitives = []\n"), isErrorAt(11, {"'primitives'", "[[hit_group]]"}));
  EXPECT_THAT(errorOf(kGroup + "primitives = \"\"\n"), isErrorAt(11, {"'primitives'", "[[hit_group]]"}));
  for (const char* name : {"name", "geometry", "material", "primitives", "record"})
    EXPECT_THAT(errorOf(changed(kSmall, "\"radiance\"", std::string("\"") + name + "\"")),
                isErrorAt(6, {std::string("'") + name + "'", "[[hit_group]]"}));
}

// Returns a program with a default scene: `head` are further keys of [program].
Program withScene(const std::string& head, const Files& more) {
  Files files = someFiles();
  files.insert(more.begin(), more.end());
  return parse(changed(kSmall, "description", head + "description"), files);
}

TEST(DefaultScene, IsTheOnlySceneFile) {
  EXPECT_EQ(withScene("", {}).scene, "");
  EXPECT_EQ(withScene("", {{"a.scene.toml", ""}, {"b.toml", ""}}).scene, "a.scene.toml");
  EXPECT_EQ(withScene("", {{"a.scene.toml", ""}, {"b.scene.toml", ""}}).scene, "");
}

TEST(DefaultScene, IsTheSceneThatTheProgramNames) {
  EXPECT_EQ(withScene("scene = \"b.scene.toml\"\n", {{"a.scene.toml", ""}, {"b.scene.toml", ""}}).scene,
            "b.scene.toml");
  EXPECT_THAT(errorOf(changed(kSmall, "description", "scene = \"c.scene.toml\"\ndescription")),
              isErrorAt(3, {"'c.scene.toml'"}));
}

}  // namespace
}  // namespace quintet::program
