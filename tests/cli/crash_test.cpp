// SPDX-License-Identifier: Apache-2.0
// A program that crashes the driver: the command ends with one error and an exit status, not with a signal.
#include <algorithm>
#include <csignal>
#include <fstream>

#include <gmock/gmock.h>

#include "sky_program.h"

namespace quintet::test {
namespace {

using testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;

// Writes to an address that no buffer has.
constexpr const char* kWildStore = R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
void main() {
  FloatArray(uint64_t(8) + gl_LaunchIDEXT.x).at[0] = 1.0;
  storeOutput(kOutput_color, launchPixel(), vec4(1.0));
}
)";

class Crash : public CliTest {
 protected:
  Crash() {
    writeSkyProgram(folder_ / "wild", "payload.color = vec3(0.5);");
    write(folder_ / "wild" / "sky.rgen", kWildStore);
  }
  // Software devices crash; others report a lost device.
  static void expectOneError(const RunResult& result) {
    EXPECT_THAT(result.status, AnyOf(4, 1)) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr("quintet: "));
    if (result.status != 4) return;
    EXPECT_THAT(result.err,
                AllOf(HasSubstr("quintet: wild: crash"), HasSubstr("while rendering"), HasSubstr("signal 11")));
    EXPECT_THAT(result.err, HasSubstr("docs/debugging.md"));
  }
};

TEST_F(Crash, IsOneErrorOfRunAndRender) {
  write(folder_ / "out.png", "an older file");
  expectOneError(quintet({"run", "wild", "--size", "16x16", "-q", "-o", "out.png"}));
  expectOneError(
      quintet({"render", "scene.gltf", "--program", "wild", "--size", "16x16", "--spp", "1", "-q", "-o", "out.png"}));
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"out.png", "scene.gltf", "wild"}));
  EXPECT_EQ(std::filesystem::file_size(folder_ / "out.png"), 13u);
}

TEST_F(Crash, IsAnErrorOfTheInstrumentedRun) {
  const RunResult result = quintet({"check", "wild", "--instrument", "--size", "16x16"});
  EXPECT_THAT(result.status, AnyOf(4, 1)) << result.err;
  EXPECT_THAT(result.err,
              HasSubstr(result.status == 4 ? "quintet: wild: crash in the driver or in Quintet while rendering "
                                             "with --instrument (signal "
                                           : "wild: error: "));
}

TEST_F(Crash, IsAnErrorInJson) {
  const RunResult result = quintet({"run", "wild", "--size", "16x16", "--json", "-q", "-o", "out.png"});
  EXPECT_EQ(nlohmann::json::parse(result.out)["error"]["exitStatus"], result.status);
  const RunResult check = quintet({"check", "wild", "--instrument", "--size", "16x16", "--json"});
  const auto array = nlohmann::json::parse(check.out);
  ASSERT_EQ(array.size(), 1u) << check.out;
  EXPECT_EQ(array[0]["id"], check.status == 4 ? "CRASH" : "");
}

// What the check of earlier programs found is printed also if a later one crashes the driver.
TEST_F(Crash, KeepsTheResultsOfEarlierPrograms) {
  writeSkyProgram(folder_ / "broken", "payload.color = undeclared;");
  const RunResult check = quintet(
      {"check", "broken", "10_sphere", "wild", "--instrument", "--size", "16x16", "--json", "--sarif", "found.sarif"});
  const auto array = nlohmann::json::parse(check.out);
  ASSERT_EQ(array.size(), 2u) << check.out;
  EXPECT_EQ(array[0]["id"], "GLSL");
  EXPECT_EQ(array[1]["id"], check.status == 4 ? "CRASH" : "");
  const auto sarif = nlohmann::json::parse(std::ifstream(folder_ / "found.sarif"));
  EXPECT_EQ(sarif["runs"][0]["results"].size(), check.status == 4 ? 1u : 2u);
  EXPECT_EQ(sarif["runs"][0]["results"][0]["ruleId"], "GLSL");
  EXPECT_EQ(sarif["runs"][0]["invocations"][0]["executionSuccessful"], check.status != 4);
}

// The compiler limits the depth of its parser, so that its stack does not overflow.
TEST_F(Crash, DeepExpressionsAreErrors) {
  const std::string nested = std::string(200000, '(') + "0.5" + std::string(200000, ')');
  writeSkyProgram(folder_ / "deep", "payload.color = vec3(" + nested + ");");
  const RunResult result = quintet({"check", "deep"});
  EXPECT_EQ(result.status, 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("memory exhausted [GLSL]"));
}

// With --watch, each crash is reported, and the next save starts over. A lost device counts as a crash.
TEST_F(Crash, IsNotTheEndOfWatching) {
  PipeRun process({"run", "wild", "--watch", "--size", "16x16", "--spp", "1", "-o", "out.png"},
                  {.folder = folder_.path()});
  ASSERT_TRUE(process.waitForNext("quintet: "));
  ASSERT_TRUE(process.waitForNext("watching 4 files; press Ctrl-C to stop\n"));
  write(folder_ / "wild" / "sky.rgen", kWildStore);
  ASSERT_TRUE(process.waitForNext("sky.rgen saved\n"));
  ASSERT_TRUE(process.waitForNext("quintet: "));
  ASSERT_TRUE(process.waitForNext("watching"));
  write(folder_ / "wild" / "program.toml", "[program");
  ASSERT_TRUE(process.waitForNext("quintet: wild/program.toml: "));
  ASSERT_TRUE(process.waitForNext("watching 1 file;"));
  writeSkyProgram(folder_ / "good", "payload.color = vec3(0.5);");
  std::filesystem::rename(folder_ / "good" / "sky.rgen", folder_ / "wild" / "sky.rgen");
  std::filesystem::rename(folder_ / "good" / "program.toml", folder_ / "wild" / "program.toml");
  ASSERT_TRUE(process.waitForNext("out.png: 16x16"));
  process.signal(SIGINT);
  EXPECT_EQ(process.finish().status, 0);
}

TEST_F(Crash, IsTheStatusOfAnInterruptedWatch) {
  PipeRun process({"run", "wild", "--watch", "--size", "16x16", "--spp", "1", "-o", "out.png"},
                  {.folder = folder_.path()});
  ASSERT_TRUE(process.waitForNext("quintet: "));
  ASSERT_TRUE(process.waitForNext("watching"));
  process.signal(SIGINT);
  EXPECT_EQ(process.finish().status, 4);
}

// The process that works is a child. It ends with its parent.
TEST_F(Crash, KillingTheProcessEndsItsChild) {
  writeSkyProgram(folder_ / "good", "payload.color = vec3(0.5);");
  TerminalRun process({"run", "good", "--size", "64x64", "--time", "1000", "-o", "out.png"}, folder_.path());
  ASSERT_TRUE(process.waitFor(" left"));
  process.signal(SIGKILL);
  EXPECT_EQ(process.finish().status, 1000 + SIGKILL);  // it waits until the child has closed the terminal
}

TEST_F(Crash, OneProcessIsPossible) {
  writeSkyProgram(folder_ / "good", "payload.color = vec3(0.5);");
  const RunResult result = quintet({"run", "good", "--size", "8x8", "--spp", "1", "-q", "-o", "out.png"},
                                   {.environment = {{"QUINTET_ISOLATION", "off"}}});
  EXPECT_EQ(result.status, 0) << result.err;
}

}  // namespace
}  // namespace quintet::test
