// SPDX-License-Identifier: Apache-2.0
// Wrong command lines: status 2 and one line that names the option, the value and the nearest name.
#include <gmock/gmock.h>

#include "check/case_file.h"
#include "fixtures.h"

namespace quintet::test {
namespace {

class Usage : public CliTest {};

TEST_F(Usage, VersionAndHelp) {
  const RunResult version = quintet({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_TRUE(version.out.starts_with("quintet 0.")) << version.out;
  EXPECT_EQ(version.err, "");
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--help"},
                                                    {"render", "--help"},
                                                    {"merge", "--help"},
                                                    {"run", "--help"},
                                                    {"new", "--help"},
                                                    {"check", "--help"},
                                                    {"explain", "--help"},
                                                    {"info", "--help"},
                                                    {"compare", "--help"},
                                                    {"bench", "--help"}}) {
    const RunResult help = quintet(arguments);
    EXPECT_EQ(help.status, 0);
    EXPECT_EQ(help.err, "");
    EXPECT_NE(help.out.find("Examples:"), std::string::npos) << help.out;
    EXPECT_EQ(help.out.find('\x1b'), std::string::npos);
  }
}

// `merge` has no list of layers.
TEST_F(Usage, HelpShowsTheValuesOfEachCommand) {
  EXPECT_NE(quintet({"render", "--help"}).out.find("--aov NAMES|all|list"), std::string::npos);
  const std::string merge = quintet({"merge", "--help"}).out;
  EXPECT_NE(merge.find("--aov NAMES|all "), std::string::npos) << merge;
  EXPECT_EQ(merge.find("list"), std::string::npos) << merge;
}

TEST_F(Usage, UnknownCommand) {
  expectError(quintet({"rendr", "scene.gltf"}), 2, {"'rendr'", "'render'"});
  expectError(quintet({"--verison"}), 2, {"'--verison'", "'--version'"});
}

TEST_F(Usage, NoCommandPrintsTheHelp) {
  const RunResult result = quintet({});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.out.find("Usage:"), std::string::npos);
}

TEST_F(Usage, UnknownOption) {
  expectError(quintet({"render", "scene.gltf", "--sice", "3x3"}), 2, {"'--sice'", "'--size'"});
  expectError(quintet({"render", "--sice=3x3"}), 2, {"'--sice'", "'--size'"});
  expectError(quintet({"info", "--jsn"}), 2, {"'--jsn'", "'--json'"});
  expectError(quintet({"compare", "a", "b", "--metrik", "flip"}), 2, {"'--metrik'", "'--metric'"});
}

TEST_F(Usage, MissingAndExcessArguments) {
  expectError(quintet({"render"}), 2, {"scene", "--help"});
  expectError(quintet({"info", "scene.gltf", "more.gltf"}), 2, {"'more.gltf'"});
  expectError(quintet({"render", "scene.gltf", "--spp"}), 2, {"--spp"});
  expectError(quintet({"compare", "a.png"}), 2, {"two images"});
}

TEST_F(Usage, Sizes) {
  for (const char* size : {"0x0", "0", "-5x10", "10x-5", "65537x10", "99999999999x1", "axb", "x", "10x", "x10",
                           "10x10x10", "1e3x10", "1 x1", "0x10x", "1.5x1", ""})
    expectError(quintet({"render", "scene.gltf", std::string("--size=") + size}), 2, {"--size", size});
}

TEST_F(Usage, NumbersOutOfRange) {
  for (const char* samples : {"0", "-3", "1.5", "many", "1x", "0x1", "inf", "16777217", "1e99"})
    expectError(quintet(quick({"--spp", samples})), 2, {"--spp", samples});
  for (const char* seconds : {"nan", "inf", "-1", "1 s"})
    expectError(quintet(quick({"--time", seconds})), 2, {"--time", seconds});
  expectError(quintet(quick({"--fov", "180"})), 2, {"--fov", "180"});
  expectError(quintet(quick({"--seed", "4294967296"})), 2, {"--seed", "4294967296"});
  expectError(quintet(quick({"--exposure", "bright"})), 2, {"--exposure", "bright"});
  expectError(quintet(quick({"--aperture", "-0.1"})), 2, {"--aperture", "-0.1"});
  expectError(quintet(quick({"--focus", "0"})), 2, {"--focus", "0"});
  expectError(quintet(quick({"--timeout", "0"})), 2, {"--timeout", "0"});
}

// The error names the permitted range.
TEST_F(Usage, RangesAreReported) {
  expectError(quintet(quick({"--exposure", "101"})), 2, {"--exposure", "101", "-100", "100"});
  expectError(quintet(quick({"--time", "-1"})), 2, {"--time", "-1", " 0"});
}

// `--spp "$N"` with an empty N does not mean the default.
TEST_F(Usage, EmptyValues) {
  for (const char* option : {"--spp", "--time", "--size", "--exposure", "--env", "--seed", "-o"})
    expectError(quintet(quick({option, ""})), 2, {"empty", option});
  expectError(quintet({"merge", "a.qfilm", "-o", "m.png", "--tonemap", ""}), 2, {"--tonemap", "empty"});
}

TEST_F(Usage, Points) {
  for (const char* point : {"1,2", "1,2,x", "1,2,3,4", "1,,3", "1,2,nan", "1,2,inf", "1,2,1e99", "1, 2,3", "+-1,2,3"})
    expectError(quintet(quick({"--look-from", point})), 2, {"--look-from", point});
  expectError(quintet(quick({"--look-at", "1,2,3"})), 2, {"look-at", "look-from"});
  expectError(quintet(quick({"--look-from", "1,2,3", "--look-at", "1,2,3"})), 2, {"look-from", "look-at"});
  expectError(quintet(quick({"--look-from", "1,2,3", "--up", "0,0,0"})), 2, {"up"});
  expectError(quintet(quick({"--look-from", "1,2,3", "--camera", "0"})), 2, {"camera", "look-from"});
  // Signs, exponents and numbers without a leading digit.
  EXPECT_EQ(quintet(quick({"--look-from", "1,-2.5,+3e1", "--look-at", "-.5,0,0", "-o", "a.png"})).status, 0);
}

TEST_F(Usage, Regions) {
  for (const char* region : {"1,2,3", "0,0,0,5", "1,2,0,4", "-1,2,3,4", "1,2,3,99999", "1,2,3,4,5"})
    expectError(quintet(quick({"--region", region})), 2, {"--region", region});
  expectError(quintet(quick({"--region", "30,0,10,10"})), 2, {"30,0,10,10", "32x24"});
}

TEST_F(Usage, UnknownNames) {
  expectError(quintet(quick({"--tonemap", "acs"})), 2, {"--tonemap", "'acs'", "'aces'", "agx"});
  expectError(quintet({"render", "scene.gltf", "--program", "pathtracr"}), 2, {"'pathtracr'", "'pathtracer'"});
  expectError(quintet(quick({"--camera", "frnt"})), 2, {"'frnt'", "'front'"});
  expectError(quintet(quick({"--camera", "7"})), 2, {"'7'", "0 'front', 1 'side'"});
  expectError(quintet({"compare", "a", "b", "--metric", "flop"}), 2, {"--metric", "'flop'", "'flip'"});
}

TEST_F(Usage, Variants) {
  expectError(quintet(quick({"--variant", "Red"})), 2, {"scene.gltf", "no variant 'Red'", "no material variants"});
  nlohmann::json scene = quadScene();
  for (const char* name : {"Red", "Green"})
    scene["extensions"]["KHR_materials_variants"]["variants"].push_back({{"name", name}});
  write(folder_ / "scene.gltf", scene.dump());
  expectError(quintet(quick({"--variant", "red"})), 2, {"no variant 'red'", "Red, Green"});
  EXPECT_EQ(quintet(quick({"--variant", "Green", "-o", "a.png"})).status, 0);
  expectError(quintet({"bench", "scene.gltf", "--variant", "red"}), 2, {"no variant 'red'", "Red, Green"});
  expectError(quintet({"bench", "normals", "scene.gltf", "--variant", "red"}), 2, {"no variant 'red'", "Red, Green"});
  const RunResult noFile = quintet({"check", "normals", "--variant", "Red", "--device", "none"});
  EXPECT_EQ(noFile.status, 2);
  EXPECT_THAT(noFile.err, testing::HasSubstr("no variant 'Red'"));
  const RunResult unknown = quintet({"check", "normals", "scene.gltf", "--variant", "red", "--device", "none"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, testing::HasSubstr("no variant 'red'"));
  EXPECT_EQ(quintet({"check", "normals", "scene.gltf", "--variant", "Red", "--device", "none"}).status, 0);
  EXPECT_THAT(quintet({"info", "scene.gltf"}).out, testing::HasSubstr("Red, Green"));
}

TEST_F(Usage, Loading) {
  nlohmann::json scene = quadScene();
  scene["images"] = {{{"uri", "none.png"}}};
  scene["textures"] = {{{"source", 0}}};
  scene["materials"] = {{{"emissiveTexture", {{"index", 0}}}}};
  write(folder_ / "scene.gltf", scene.dump());
  expectError(quintet(quick({"-o", "a.png"})), 1, {"/images/0/uri", "none.png", "--missing-textures warn"});
  EXPECT_EQ(quintet(quick({"-o", "a.png", "--missing-textures", "warn"})).status, 0);
  expectError(quintet(quick({"--missing-textures", "ignore"})), 2, {"--missing-textures", "'ignore'", "warn"});
  expectError(quintet(quick({"--missing-textures", "warn", "--strict"})), 2, {"--strict", "--missing-textures"});
  scene["images"][0]["uri"] = "../none.png";
  write(folder_ / "scene.gltf", scene.dump());
  expectError(quintet(quick({})), 1, {"../none.png", "outside", "--allow-external"});
  expectError(quintet(quick({"--allow-external"})), 1, {"../none.png", "does not exist"});
  for (const char* bytes : {"0", "x", "G", "-1", "1e99", "5Q"})
    expectError(quintet(quick({"--max-memory", bytes})), 2, {"--max-memory", bytes});
  expectError(quintet(quick({"--max-memory", "100"})), 1, {"scene.gltf", "100 bytes", "--max-memory"});
  expectError(quintet(quick({"--scene", "none"})), 2, {"scene.gltf", "no scene 'none'"});
}

TEST_F(Usage, Parameters) {
  expectError(quintet({"render", "scene.gltf", "--set", "bouncs=3"}), 2, {"'bouncs'", "'bounces'"});
  expectError(quintet({"render", "scene.gltf", "--set", "bounces"}), 2, {"bounces"});
  expectError(quintet({"render", "scene.gltf", "--set", "bounces=many"}), 2, {"bounces", "many"});
  expectError(quintet({"render", "scene.gltf", "--set", "bounces=-1"}), 2, {"bounces", "-1"});
  expectError(quintet({"render", "scene.gltf", "--bounces", "-1"}), 2, {"bounces", "-1"});
  expectError(quintet({"render", "scene.gltf", "--clamp", "x"}), 2, {"clamp", "x"});
  expectError(quintet(quick({"--bounces", "3"})), 2, {"'bounces'"});
}

TEST_F(Usage, ProgramHelpListsTheParameters) {
  const RunResult result = quintet({"render", "--program", "pathtracer", "--help-program"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find("bounces"), std::string::npos);
  EXPECT_NE(result.out.find("default"), std::string::npos);
}

// The text names only options of its command.
TEST_F(Usage, ProgramHelpNamesTheOptionsOfTheCommand) {
  const auto optionsIn = [](const std::string& text) {
    std::vector<std::string> names;
    const std::size_t begin = text.find("Options: ");
    for (std::size_t at = text.find("--", begin); at != text.npos; at = text.find("--", at + 2))
      names.push_back(text.substr(at, text.find_first_of(" ,;.'", at) - at));
    return names;
  };
  const std::filesystem::path idiom = folder_ / "idiom";
  writeCase(readCase(QUINTET_SOURCE_ROOT "/tests/check/idioms/program_averages_its_frames.case"), idiom);
  for (const std::string& program : {std::string("pathtracer"), idiom.string()}) {
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"render", "--program", program, "--help-program"}, {"run", program, "--help"}}) {
      const std::string help = quintet({command[0], "--help"}).out;
      const std::vector<std::string> names = optionsIn(quintet(command).out);
      EXPECT_GE(names.size(), 4u);
      for (const std::string& name : names)
        EXPECT_THAT(help, testing::ContainsRegex(" " + name + "[ ,\n]")) << command[0];
    }
  }
}

TEST_F(Usage, SetMayBeRepeated) {
  const RunResult result = quintet({"render", "scene.gltf", "--program", "ao", "--size", "8x8", "--spp", "1", "-q",
                                    "--set", "distance=2", "--set", "background=0,0.5,1", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string parameters = nlohmann::json::parse(result.out)["parameters"];
  EXPECT_NE(parameters.find("distance=2"), std::string::npos) << parameters;
  EXPECT_NE(parameters.find("background=0,0.5,1"), std::string::npos) << parameters;
}

// A shell can execute the recorded command again.
TEST_F(Usage, TheRecordedCommandIsQuoted) {
  std::filesystem::rename(folder_ / "scene.gltf", folder_ / "my scene.gltf");
  const RunResult result = quintet({"render", "my scene.gltf", "--program", "normals", "--size", "8x8", "--spp", "1",
                                    "-q", "--env", "0.1,0.2,0.3", "-o", "it's.png", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(
      nlohmann::json::parse(result.out)["command"],
      "quintet render 'my scene.gltf' --program normals --size 8x8 --spp 1 -q --env 0.1,0.2,0.3 -o 'it'\\''s.png' "
      "--json");
}

TEST_F(Usage, Outputs) {
  expectError(quintet(quick({"-o", "out.jpg"})), 2, {"out.jpg", ".png, .exr, .hdr or .qfilm"});
  expectError(quintet(quick({"-o", "out"})), 2, {"extension"});
  EXPECT_EQ(expectJsonError(quintet(quick({"-o", "-", "--json"})), 2, {"--json"})["file"], nullptr);
  EXPECT_EQ(fileNames(), std::vector<std::string>{"scene.gltf"});
}

}  // namespace
}  // namespace quintet::test
