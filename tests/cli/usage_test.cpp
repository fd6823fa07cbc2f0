// Commands and options that make no sense: status 2, one line, the nearest name where there is one.
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
                                                    {"info", "--help"},
                                                    {"merge", "--help"},
                                                    {"compare", "--help"}}) {
    const RunResult help = quintet(arguments);
    EXPECT_EQ(help.status, 0);
    EXPECT_EQ(help.err, "");
    EXPECT_NE(help.out.find("Examples:"), std::string::npos) << help.out;
    EXPECT_EQ(help.out.find('\x1b'), std::string::npos);
  }
}

// What merge takes of --aov is not what render takes.
TEST_F(Usage, HelpOffersOnlyWhatIsTaken) {
  EXPECT_NE(quintet({"render", "--help"}).out.find("--aov NAMES|all|list"), std::string::npos);
  const std::string merge = quintet({"merge", "--help"}).out;
  EXPECT_NE(merge.find("--aov NAMES|all "), std::string::npos) << merge;
  EXPECT_EQ(merge.find("list"), std::string::npos) << merge;
}

TEST_F(Usage, UnknownCommand) {
  expectError(quintet({"rendr", "scene.gltf"}), 2, {"unknown command 'rendr'", "did you mean 'render'?"});
  expectError(quintet({"--verison"}), 2, {"unknown option '--verison'", "did you mean '--version'?"});
}

TEST_F(Usage, NoCommandShowsTheHelp) {
  const RunResult result = quintet({});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.out.find("Usage:"), std::string::npos);
}

TEST_F(Usage, UnknownOption) {
  expectError(quintet({"render", "scene.gltf", "--sice", "3x3"}), 2,
              {"unknown option '--sice'", "did you mean '--size'?"});
  expectError(quintet({"render", "--sice=3x3"}), 2, {"unknown option '--sice'", "did you mean '--size'?"});
  expectError(quintet({"info", "--jsn"}), 2, {"unknown option '--jsn'", "did you mean '--json'?"});
  expectError(quintet({"compare", "a", "b", "--metrik", "flip"}), 2, {"did you mean '--metric'?"});
}

TEST_F(Usage, MissingOrSuperfluousArguments) {
  expectError(quintet({"render"}), 2, {"no scene"});
  expectError(quintet({"render", "scene.gltf", "more.gltf"}), 2, {"unexpected argument 'more.gltf'"});
  expectError(quintet({"render", "scene.gltf", "--spp"}), 2, {"--spp"});
  expectError(quintet({"compare", "a.png"}), 2, {"two pictures"});
}

TEST_F(Usage, SizesThatMakeNoSense) {
  for (const char* size :
       {"0x0", "0", "-5x10", "10x-5", "65537x10", "99999999999x1", "axb", "10x", "x10", "10x10x10", "1e3x10", ""})
    expectError(quintet({"render", "scene.gltf", std::string("--size=") + size}), 2, {"--size"});
}

TEST_F(Usage, NumbersOutOfRange) {
  expectError(quintet(quick({"--spp", "0"})), 2, {"--spp", "0"});
  expectError(quintet(quick({"--spp", "-3"})), 2, {"--spp", "-3"});
  expectError(quintet(quick({"--spp", "1.5"})), 2, {"--spp", "whole number"});
  expectError(quintet(quick({"--spp", "many"})), 2, {"--spp", "not a number"});
  expectError(quintet(quick({"--time", "nan"})), 2, {"--time", "not a number"});
  expectError(quintet(quick({"--time", "-1"})), 2, {"--time"});
  expectError(quintet(quick({"--fov", "180"})), 2, {"--fov"});
  expectError(quintet(quick({"--seed", "4294967296"})), 2, {"--seed"});
  expectError(quintet(quick({"--exposure", "bright"})), 2, {"--exposure"});
  expectError(quintet(quick({"--aperture", "-0.1"})), 2, {"--aperture"});
  expectError(quintet(quick({"--focus", "0"})), 2, {"--focus"});
  expectError(quintet(quick({"--timeout", "0"})), 2, {"--timeout"});
}

// "$N" with nothing in N is no wish for the default.
TEST_F(Usage, EmptyValues) {
  for (const char* option : {"--spp", "--time", "--size", "--exposure", "--env", "--seed", "-o"})
    expectError(quintet(quick({option, ""})), 2, {"value is empty", option});
  expectError(quintet({"merge", "a.qfilm", "-o", "m.png", "--tonemap", ""}), 2, {"--tonemap", "empty"});
}

TEST_F(Usage, VectorsAndRegions) {
  expectError(quintet(quick({"--look-from", "1,2"})), 2, {"--look-from", "three numbers"});
  expectError(quintet(quick({"--look-from", "1,2,x"})), 2, {"--look-from", "three numbers"});
  expectError(quintet(quick({"--look-at", "1,2,3"})), 2, {"--look-at needs --look-from"});
  expectError(quintet(quick({"--look-from", "1,2,3", "--look-at", "1,2,3"})), 2, {"same point"});
  expectError(quintet(quick({"--look-from", "1,2,3", "--up", "0,0,0"})), 2, {"--up"});
  expectError(quintet(quick({"--look-from", "1,2,3", "--camera", "0"})), 2, {"exclude each other"});
  expectError(quintet(quick({"--region", "1,2,3"})), 2, {"--region"});
  expectError(quintet(quick({"--region", "0,0,0,5"})), 2, {"--region"});
  expectError(quintet(quick({"--region", "30,0,10,10"})), 2, {"30,0,10,10", "32x24"});
}

TEST_F(Usage, NamesThatDoNotExist) {
  expectError(quintet(quick({"--tonemap", "acs"})), 2, {"'acs'", "did you mean 'aces'?"});
  expectError(quintet({"render", "scene.gltf", "--program", "pathtracr"}), 2, {"pathtracr", "pathtracer"});
  expectError(quintet(quick({"--camera", "frnt"})), 2, {"frnt", "did you mean 'front'?"});
  expectError(quintet(quick({"--camera", "7"})), 2, {"'7'", "0 to 1"});
  expectError(quintet({"compare", "a", "b", "--metric", "flop"}), 2, {"flop", "did you mean 'flip'?"});
}

TEST_F(Usage, Parameters) {
  expectError(quintet({"render", "scene.gltf", "--set", "bouncs=3"}), 2, {"bouncs", "bounces"});
  expectError(quintet({"render", "scene.gltf", "--set", "bounces"}), 2, {"bounces"});
  expectError(quintet({"render", "scene.gltf", "--set", "bounces=many"}), 2, {"bounces", "many"});
  expectError(quintet({"render", "scene.gltf", "--set", "bounces=-1"}), 2, {"bounces", "-1"});
  expectError(quintet({"render", "scene.gltf", "--bounces", "-1"}), 2, {"bounces", "-1"});
  expectError(quintet({"render", "scene.gltf", "--clamp", "x"}), 2, {"clamp", "x"});
  expectError(quintet(quick({"--bounces", "3"})), 2, {"--bounces", "'normals' has no parameter"});
}

TEST_F(Usage, ProgramHelpNamesTheParameters) {
  const RunResult result = quintet({"render", "--program", "pathtracer", "--help-program"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find("bounces"), std::string::npos);
  EXPECT_NE(result.out.find("default"), std::string::npos);
}

TEST_F(Usage, SetMayBeRepeated) {
  const RunResult result = quintet({"render", "scene.gltf", "--program", "ao", "--size", "8x8", "--spp", "1", "-q",
                                    "--set", "distance=2", "--set", "background=0,0.5,1", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string parameters = nlohmann::json::parse(result.out)["parameters"];
  EXPECT_NE(parameters.find("distance=2"), std::string::npos) << parameters;
  EXPECT_NE(parameters.find("background=0,0.5,1"), std::string::npos) << parameters;
}

TEST_F(Usage, OutputsThatMakeNoSense) {
  expectError(quintet(quick({"-o", "out.jpg"})), 2, {"out.jpg", ".png, .exr, .hdr or .qfilm"});
  expectError(quintet(quick({"-o", "out"})), 2, {"extension"});
  expectError(quintet(quick({"-o", "-", "--json"})), 2, {"--json"});
  EXPECT_EQ(fileNames(), std::vector<std::string>{"scene.gltf"});
}

}  // namespace
}  // namespace quintet::test
