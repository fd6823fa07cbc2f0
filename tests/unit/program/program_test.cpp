// program.toml: what is read, and every way to be wrong with the line and a hint.
#include "program_test_support.h"

#include <filesystem>
#include <ostream>

#include "base/file.h"
#include "temp_folder.h"

namespace quintet::program {
namespace {

const std::string kFull = R"([program]
description = "all there is"
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
help = "a colour"
)";

TEST(Program, ReadsEverything) {
  const Program p = parse(kFull);
  EXPECT_EQ(p.name, "demo");
  EXPECT_EQ(p.origin, "folder/demo");
  EXPECT_EQ(p.description, "all there is");
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
  EXPECT_EQ(tint.help, "a colour");
}

TEST(Program, FillsInDefaults) {
  const Program p = parse(kSmall);
  EXPECT_FALSE(p.declaredRecursion.has_value());
  EXPECT_EQ(p.accumulation, Accumulation::film);
  EXPECT_FALSE(p.keepsInstanceOrder);
  EXPECT_EQ(p.samplesPerLaunch, 1u);
  EXPECT_EQ(outputNames(p), std::vector<std::string>{"color"});
  EXPECT_TRUE(p.hitGroups.empty());
  EXPECT_TRUE(p.parameters.empty());
}

TEST(Program, ChannelsFollowFromTheKind) {
  using Names = std::vector<std::string>;
  const auto output = [](const std::string& keys) {
    return parse(std::string(kSmall) + "\n[[output]]\nname = \"a\"\n" + keys + "\n").outputs.at(0);
  };
  EXPECT_EQ(outputChannels(output("kind = \"color\"")), (Names{"R", "G", "B"}));
  EXPECT_TRUE(holdsColor(output("kind = \"color\"")));
  EXPECT_EQ(outputChannels(output("kind = \"linear\"")), (Names{"X", "Y", "Z"}));
  EXPECT_EQ(outputChannels(output("kind = \"normal\"")), (Names{"X", "Y", "Z"}));
  EXPECT_EQ(outputChannels(output("kind = \"depth\"")), (Names{"Z"}));
  EXPECT_EQ(outputChannels(output("kind = \"id\"")), (Names{"X"}));
  EXPECT_FALSE(holdsColor(output("kind = \"id\"")));
  const Output said = output("channels = [\"R\", \"G\", \"B\", \"A\"]");
  EXPECT_EQ(outputChannels(said), (Names{"R", "G", "B", "A"}));
  EXPECT_TRUE(holdsColor(said));
  EXPECT_FALSE(holdsColor(output("channels = [\"R\", \"G\"]")));
}

TEST(Program, TellsLibraryStages) {
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
  std::string error;
};

void PrintTo(const WrongCase& c, std::ostream* out) { *out << c.to; }

class ProgramErrors : public testing::TestWithParam<WrongCase> {};

TEST_P(ProgramErrors, NameTheLineAndTheProblem) {
  const WrongCase& c = GetParam();
  EXPECT_EQ(errorOf(changed(kFull, c.from, c.to)), c.error);
}

const WrongCase kWrong[] = {
    {"UnknownKeyOfProgram", "max_recursion", "max_recursoin",
     "line 4: [program] has no key 'max_recursoin'; did you mean 'max_recursion'?"},
    {"UnknownKeyOfRay", "miss = \"sky.rmiss\"", "miss = \"sky.rmiss\"\nmis = 1",
     "line 11: [[ray]] has no key 'mis'; did you mean 'miss'?"},
    {"UnknownKeyWithoutHint", "unit", "zzzzzzzzzzzzzzzz", "line 39: [[parameter]] has no key 'zzzzzzzzzzzzzzzz'"},
    {"UnknownKeyAtTheTop", "[[output]]", "[[outputs]]",
     "line 27: program.toml has no key 'outputs'; did you mean 'output'?"},
    {"UnknownStage", "{ closest_hit", "{ closes_hit",
     "line 19: 'radiance' of [[hit_group]] has no key 'closes_hit'; did you mean 'closest_hit'?"},
    {"UnknownRay", "shadow = {", "shadows = {", "line 25: [[hit_group]] has no key 'shadows'; did you mean 'shadow'?"},
    {"UnknownKeyOfOutput", "name = \"depth\"", "name = \"depth\"\ntype = 1", "line 32: [[output]] has no key 'type'"},
    {"ChannelTwice", "name = \"depth\"", "name = \"depth\"\nchannels = [\"X\", \"X\"]",
     "line 32: 'channels' are one to four different names of letters, digits and _"},
    {"ChannelWithDot", "name = \"depth\"", "name = \"depth\"\nchannels = \"a.R\"",
     "line 32: 'channels' are one to four different names of letters, digits and _"},
    {"TooManyChannels", "name = \"depth\"", "name = \"depth\"\nchannels = [\"A\", \"B\", \"C\", \"D\", \"E\"]",
     "line 32: 'channels' are one to four different names of letters, digits and _"},
    {"MissingFile", "main.rgen", "mian.rgen",
     "line 3: there is no file 'mian.rgen' in folder/demo; did you mean 'main.rgen'?"},
    {"MissingCallable", "noise.rcall", "none.rcall",
     "line 6: there is no file 'none.rcall' in folder/demo; did you mean 'noise.rcall'?"},
    {"WrongExtension", "closest_hit = \"hit.rchit\"", "closest_hit = \"alpha.rahit\"",
     "line 19: 'alpha.rahit' must end in .rchit"},
    {"WrongLibraryExtension", "shadow.rmiss", "surface.rchit",
     "line 14: '<quintet/stages/surface.rchit>' must end in .rmiss"},
    {"DuplicateRay", "name = \"shadow\"", "name = \"radiance\"", "line 13: 'radiance' is there twice"},
    {"DuplicateHitGroup", "name = \"boxes\"", "name = \"solid\"", "line 22: 'solid' is there twice"},
    {"DuplicateOutput", "name = \"depth\"", "name = \"color\"", "line 31: 'color' is there twice"},
    {"NoIdentifier", "name = \"depth\"", "name = \"depth of field\"", "line 31: 'depth of field' is not an identifier"},
    {"ReservedName", "name = \"tint\"", "name = \"gl_Tint\"", "line 34: 'gl_Tint' is not an identifier"},
    {"DigitFirst", "name = \"tint\"", "name = \"2tint\"", "line 34: '2tint' is not an identifier"},
    {"UnknownType", "type = \"color\"", "type = \"colour\"", "line 35: 'colour' is no type; did you mean 'color'?"},
    {"TypeFarFromAny", "type = \"color\"", "type = \"polynomial\"",
     "line 35: 'polynomial' is no type; there are bool, int, float, vec2, vec3, vec4, color, uint, choice, image"},
    {"DefaultTooShort", "[0.5, 1, 0.25]", "[0.5, 1]", "line 36: the default of 'tint' needs 3 numbers"},
    {"DefaultNoList", "[0.5, 1, 0.25]", "0.5", "line 36: the default of 'tint' needs 3 numbers"},
    {"DefaultOutside", "0.25]", "3]", "line 36: the default of 'tint' is outside 0 … 2"},
    {"DefaultNoNumber", "0.25]", "\"x\"]", "line 36: the default of 'tint' must be a number"},
    {"RecursionTooDeep", "max_recursion = 3", "max_recursion = 32",
     "line 4: 'max_recursion' of [program] must be an integer from 1 to 31"},
    {"CountNoInteger", "samples_per_launch = 16", "samples_per_launch = 1.5",
     "line 5: 'samples_per_launch' of [program] must be an integer from 1 to 4096"},
    {"TextNoString", "description = \"all there is\"", "description = 3",
     "line 2: 'description' of [program] must be a string"},
    {"CallablesNoList", "[\"noise.rcall\"]", "\"noise.rcall\"", "line 6: 'callables' must be a list of files"},
    {"CallablesNoNames", "[\"noise.rcall\"]", "[1]", "line 6: 'callables' must be a list of files"},
    {"StagesNoTable", "{ closest_hit = \"hit.rchit\" }", "\"hit.rchit\"",
     "line 19: 'radiance' must be a table such as { closest_hit = \"a.rchit\" }"},
};

INSTANTIATE_TEST_SUITE_P(Each, ProgramErrors, testing::ValuesIn(kWrong),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(Program, NeedsWhatItNeeds) {
  EXPECT_EQ(errorOf("x = 1\n"), "line 1: [program] is missing");
  EXPECT_EQ(errorOf(changed(kSmall, "ray_generation = \"main.rgen\"\n", "")),
            "line 1: [program] needs 'ray_generation'");
  EXPECT_EQ(errorOf(changed(kSmall, "miss = \"sky.rmiss\"", "")), "line 5: [[ray]] needs 'miss'");
  EXPECT_EQ(errorOf(changed(kSmall, "name = \"radiance\"", "")), "line 5: [[ray]] needs 'name'");
  EXPECT_EQ(errorOf("[program]\nray_generation = \"main.rgen\"\n"), "line 1: at least one [[ray]] is needed");
  EXPECT_EQ(errorOf(std::string(kSmall) + "[[parameter]]\nname = \"a\"\ntype = \"int\"\n"),
            "line 8: parameter 'a' needs a default");
  EXPECT_EQ(errorOf(std::string(kSmall) + "[[parameter]]\nname = \"a\"\n"), "line 8: [[parameter]] needs 'type'");
  EXPECT_EQ(errorOf(std::string(kSmall) + "[output]\nname = \"a\"\n"),
            "line 8: 'output' must be written as [[output]]");
}

TEST(Program, ReportsBrokenToml) {
  const std::string error = errorOf("[program]\nray_generation = \"main.rgen\nmax_recursion = 3\n");
  EXPECT_TRUE(error.starts_with("line 2: ")) << error;
  EXPECT_FALSE(errorOf("[program]\n[program]\n").empty());
  EXPECT_FALSE(errorOf(std::string("a = \"\0\"", 7)).empty());
}

TEST(Program, HasAtMostFifteenRayTypes) {
  std::string toml = kSmall;
  const auto ray = [](int i) { return "[[ray]]\nname = \"r" + std::to_string(i) + "\"\nmiss = \"sky.rmiss\"\n"; };
  for (int i = 1; i < 15; ++i) toml += ray(i);
  EXPECT_EQ(parse(toml).rays.size(), 15u);
  EXPECT_EQ(errorOf(toml + ray(15)), "line 50: more than 15 ray types do not fit the 4-bit stride");
}

TEST(Program, LoadsAFolder) {
  const test::TempFolder folder;
  const std::filesystem::path path = folder.path() / "mine";
  std::filesystem::create_directories(path);
  EXPECT_THROW(loadProgram(path.string()), FileError);  // no program.toml
  writeFile(path / "program.toml", std::string_view(kSmall));
  EXPECT_THROW(loadProgram(path.string()), FileError);  // no main.rgen
  writeFile(path / "main.rgen", std::string_view("void main() {}"));
  writeFile(path / "sky.rmiss", std::string_view("void main() {}"));
  for (const std::filesystem::path& name : {path, path / "program.toml"}) {
    const Program p = loadProgram(name.string());
    EXPECT_EQ(p.name, "mine");
    EXPECT_EQ(p.origin, path.string());
    EXPECT_EQ(p.files.at("main.rgen"), "void main() {}");
  }
}

TEST(Program, LessonsHaveShortNames) {
  const std::string full = "lessons/05_shadow";
  const Program program = loadProgram(full);
  for (const char* name : {"05_shadow", "shadow"}) {
    EXPECT_EQ(loadProgram(name).origin, program.origin);
    EXPECT_EQ(loadProgram(name).files, program.files);
  }
  EXPECT_EQ(loadProgram("ao").name, "ao");
  EXPECT_THROW(loadProgram("lessons"), UsageError);
  try {
    loadProgram("shadw");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'lessons/05_shadow'?"), std::string::npos) << error.what();
  }
}

TEST(Program, NamesTheNearestBuiltIn) {
  try {
    loadProgram("pathtrace");
    FAIL();
  } catch (const UsageError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("no program 'pathtrace'"), std::string::npos) << text;
    EXPECT_NE(text.find("did you mean 'pathtracer'?"), std::string::npos) << text;
  }
  EXPECT_THROW(loadProgram(""), UsageError);
  EXPECT_THROW(loadProgram("no/such/folder"), UsageError);
}

}  // namespace
}  // namespace quintet::program
