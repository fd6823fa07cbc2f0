// SPDX-License-Identifier: Apache-2.0
// A shader with an infinite loop: one line of error within the time limit.
#include <chrono>

#include <gmock/gmock.h>

#include "sky_program.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;

// The loop depends on memory that it writes, so that no compiler removes it.
constexpr const char* kEndless = R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
void main() {
  const uvec2 pixel = launchPixel();
  while (true) {
    vec4 sum = loadOutput(kOutput_color, pixel);
    storeOutput(kOutput_color, pixel, sum + 1.0);
    if (sum.x < -1.0) break;
  }
}
)";

class Timeout : public CliTest {
 protected:
  Timeout() {
    writeSkyProgram(folder_ / "good", "payload.color = vec3(0.5);");
    writeSkyProgram(folder_ / "loop", "payload.color = vec3(0.5);");
    write(folder_ / "loop" / "sky.rgen", kEndless);
  }
  // Returns the duration of the command in seconds.
  double expectTimeout(const std::vector<std::string>& arguments) {
    const auto start = std::chrono::steady_clock::now();
    const RunResult result = quintet(arguments);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    EXPECT_EQ(result.status, 1) << result.err;
    EXPECT_THAT(result.err, ::testing::ContainsRegex("quintet: loop: .* 2 s.*--timeout"));
    EXPECT_TRUE(result.err.ends_with('\n')) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out.png"));
    return seconds;
  }
};

TEST_F(Timeout, EndsRunAndRender) {
  // Two seconds for the launch; the rest is for device start and compilation on a busy machine.
  EXPECT_LT(expectTimeout({"run", "loop", "--timeout", "2", "--size", "64x64", "-q", "-o", "out.png"}), 20.0);
  EXPECT_LT(expectTimeout({"render", "scene.gltf", "--program", "loop", "--timeout", "2", "--size", "64x64", "-q", "-o",
                           "out.png"}),
            20.0);
}

TEST_F(Timeout, IsADiagnosticInJson) {
  const RunResult result = quintet({"run", "loop", "--timeout", "2", "--size", "8x8", "--json", "-o", "out.png"});
  EXPECT_EQ(result.status, 1);
  const auto array = nlohmann::json::parse(result.out);
  EXPECT_EQ(array[0]["id"], "HANG");
  EXPECT_EQ(array[0]["file"], "loop/sky.rgen");
}

TEST_F(Timeout, OfTheInstrumentedRunKeepsTheResultsBefore) {
  writeSkyProgram(folder_ / "bad", "payload.tint = vec3(0.5);");
  const RunResult result = quintet(
      {"check", "bad", "loop", "--instrument", "--timeout", "2", "--size", "8x8", "--json", "--sarif", "out.sarif"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, ::testing::ContainsRegex("quintet: loop: .* 2 s.*--timeout"));
  const auto array = nlohmann::json::parse(result.out);
  ASSERT_GE(array.size(), 2u) << result.out;
  EXPECT_EQ(array.front()["id"], "GLSL");
  EXPECT_EQ(array.back()["id"], "HANG");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out.sarif"));
}

TEST_F(Timeout, EndsWatchAndKeepsTheLastImage) {
  TerminalRun process({"run", "good", "--watch", "--timeout", "2", "--size", "16x16", "--spp", "1", "-o", "out.png"},
                      folder_.path());
  ASSERT_TRUE(process.waitForNext("out.png: 16x16"));
  write(folder_ / "good" / "sky.rgen", kEndless);
  ASSERT_TRUE(process.waitForNext("within 2 s"));
  EXPECT_EQ(process.finish().status, 1);
  EXPECT_EQ(readImage("out.png").width, 16u);
}

TEST_F(Timeout, DoesNotAffectShortLaunches) {
  const RunResult result = quintet({"run", "good", "--timeout", "60", "--size", "16x16", "-q", "-o", "out.png"});
  EXPECT_EQ(result.status, 0) << result.err;
}

}  // namespace
}  // namespace quintet::test
