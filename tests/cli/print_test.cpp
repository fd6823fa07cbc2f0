// SPDX-License-Identifier: Apache-2.0
// --print: what shaders print appears on standard error, or in the JSON report.
#include <csignal>
#include <string>

#include <gmock/gmock.h>

#include "fixtures.h"

namespace quintet::test {
namespace {

using testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kPrintingProgram = R"(struct RayPayloadType { vec3 color; };
void main() { /**** RAY GENERATION SHADER ****/
  debugPrintfEXT("x = %d", gl_LaunchIDEXT.x);
  gsnSetPixel(vec4(1.0));
}
void main() { /**** MISS SHADER ****/ }
)";

class Print : public CliTest {
 protected:
  Print() { write(folder_ / "demo.rt.glsl", kPrintingProgram); }
  RunResult demo(std::vector<std::string> more) {
    std::vector<std::string> arguments{"run", "demo.rt.glsl", "--size", "8x4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return quintet(arguments);
  }
};

TEST_F(Print, LinesAreOnStandardError) {
  const RunResult result = demo({"--print", "--frames", "2", "--quiet"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err,
            "demo.rt.glsl:3: pixel 4,2, frame 0: x = 4\n"
            "demo.rt.glsl:3: pixel 4,2, frame 1: x = 4\n");
}

TEST_F(Print, PixelsCanBeChosen) {
  EXPECT_EQ(demo({"--print=7,0", "-q"}).err, "demo.rt.glsl:3: pixel 7,0, frame 0: x = 7\n");
  EXPECT_EQ(demo({"--print=6,1,2,1", "-q"}).err,
            "demo.rt.glsl:3: pixel 6,1, frame 0: x = 6\ndemo.rt.glsl:3: pixel 7,1, frame 0: x = 7\n");
  const RunResult all = demo({"--print=all", "--print-limit", "3"});
  EXPECT_THAT(all.err, HasSubstr("pixel 2,0, frame 0: x = 2\n"));
  EXPECT_THAT(all.err, Not(HasSubstr("x = 3")));
  EXPECT_THAT(all.err, AllOf(HasSubstr("29 printed lines"), HasSubstr("--print-limit")));
}

TEST_F(Print, WithoutTheOptionANoteNamesIt) {
  const RunResult result = demo({});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("debugPrintfEXT"), HasSubstr("--print ")));
  EXPECT_THAT(result.err, Not(HasSubstr("x = ")));
  EXPECT_EQ(demo({"--quiet"}).err, "");
}

TEST_F(Print, LinesAreInTheReport) {
  const RunResult result = demo({"--print=3,2", "--json", "--quiet"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const auto printed = nlohmann::json::parse(result.out)["printed"];
  EXPECT_EQ(printed, nlohmann::json::parse(R"({"lines": [{"pixel": [3, 2], "frame": 0, "stage": "demo.rt.glsl.rgen",
              "file": "demo.rt.glsl", "line": 3, "text": "x = 3"}], "omitted": 0})"));
  EXPECT_FALSE(nlohmann::json::parse(demo({"--json", "-q"}).out).contains("printed"));
}

TEST_F(Print, LinesCanBeObjects) {
  const RunResult result =
      quintet({"render", "scene.gltf", "--program", "demo.rt.glsl", "--size", "8x4", "--print=3,2", "--json-progress"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr(R"({"print":{"pixel":[3,2],"frame":0,)"));
}

// A save ends a render. What it printed does not count for the next one.
TEST_F(Print, AnAbandonedRenderIsForgotten) {
  TerminalRun process({"run", "demo.rt.glsl", "--watch", "--print", "--print-limit", "2", "--size", "8x4", "--time",
                       "100000", "-o", "out.png"},
                      folder_.path());
  ASSERT_TRUE(process.waitForNext("frame 1: x = 4"));
  ASSERT_TRUE(process.waitForNext(" left"));
  std::string silent = kPrintingProgram;
  silent.erase(silent.find("  debugPrintfEXT"), silent.find("  gsnSetPixel") - silent.find("  debugPrintfEXT"));
  write(folder_ / "demo.rt.glsl", silent);
  ASSERT_TRUE(process.waitForNext("no shader calls debugPrintfEXT"));
  ASSERT_TRUE(process.waitForNext("demo.rt.glsl saved: "));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_THAT(result.err, Not(HasSubstr("omitted")));
}

TEST_F(Print, WrongValuesAreUsageErrors) {
  for (const char* value : {"3", "1,2,3", "1,2,0,4", "a,b", "-1,2", "center,"})
    expectError(demo({std::string("--print=") + value}), 2, {"--print", value});
  expectError(demo({"--print=8,0"}), 2, {"8,0,1,1", "0,0,8,4"});
  expectError(demo({"--print-limit", "5"}), 2, {"--print-limit requires --print"});
  expectError(demo({"--print", "--print-limit", "0"}), 2, {"--print-limit"});
}

}  // namespace
}  // namespace quintet::test
