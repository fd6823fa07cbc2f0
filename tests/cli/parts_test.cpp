// The parts of the command line that need no process: values of options, the progress bar.
#include <limits>

#include <gtest/gtest.h>

#include "base/error.h"
#include "progress.h"
#include "values.h"

namespace quintet::app {
namespace {

TEST(Values, Sizes) {
  EXPECT_EQ(parseSize("--size", "1280x720"), uvec2(1280, 720));
  EXPECT_EQ(parseSize("--size", "65536x1"), uvec2(65536, 1));
  EXPECT_EQ(parseSize("--size", "800"), uvec2(800, 0));
  for (const char* text : {"", "x", "0x1", "65537x1", "1x1x1", "1 x1", "0x10x", "-1x1", "1.5x1"})
    EXPECT_THROW(parseSize("--size", text), UsageError) << text;
}

TEST(Values, Vectors) {
  EXPECT_EQ(parseVec3("--up", "1,-2.5,+3e1"), vec3(1, -2.5f, 30));
  EXPECT_EQ(parseVec3("--up", "-.5,0,0"), vec3(-0.5f, 0, 0));
  for (const char* text : {"", "1,2", "1,2,3,4", "1,,3", "1,2,nan", "1,2,inf", "1,2,1e99", "1, 2,3", "+-1,2,3"})
    EXPECT_THROW(parseVec3("--up", text), UsageError) << text;
}

TEST(Values, Regions) {
  const render::Region region = parseRegion("--region", "1,2,30,40");
  EXPECT_EQ(region.x, 1u);
  EXPECT_EQ(region.height, 40u);
  for (const char* text : {"", "1,2,3", "1,2,0,4", "-1,2,3,4", "1,2,3,99999"})
    EXPECT_THROW(parseRegion("--region", text), UsageError) << text;
}

TEST(Values, Numbers) {
  EXPECT_EQ(parseNumber("--x", "2.5", 0, 10), 2.5);
  for (const char* text : {"", "11", "-1", "1x", "inf", "nan", "0x1"})
    EXPECT_THROW(parseNumber("--x", text, 0, 10), UsageError) << text;
  try {
    parseNumber("--x", "11", 0, 10);
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "--x: '11' is not in [0, 10]");
  }
}

TEST(Values, ShellLine) {
  const std::vector<std::string> arguments{"my scene.glb", "-o", "it's.png", "--env", "0.1,0.2,0.3", ""};
  EXPECT_EQ(commandLine("render", arguments), "quintet render 'my scene.glb' -o 'it'\\''s.png' --env 0.1,0.2,0.3 ''");
}

TEST(Values, Texts) {
  EXPECT_EQ(bytesText(1023), "1023 bytes");
  EXPECT_EQ(bytesText(1536), "1.5 KiB");
  EXPECT_EQ(bytesText(std::uint64_t{3} << 30), "3.0 GiB");
  EXPECT_EQ(durationText(2.34), "2.3 s");
  EXPECT_EQ(durationText(75), "75 s");
  EXPECT_EQ(durationText(125), "2:05");
  EXPECT_EQ(durationText(3725), "1:02:05");
  EXPECT_EQ(durationText(std::numeric_limits<double>::infinity()), "?");
  EXPECT_EQ(plain("a\x1b[31m\nb\x7f"), "a?[31m?b?");
  EXPECT_EQ(plain("größe"), "größe");
}

ProgressState half() {
  ProgressState state;
  state.samples = 32;
  state.seconds = 20;
  state.raysPerSecond = 12.34e6;
  state.sampleLimit = 64;
  return state;
}

TEST(ProgressBar, LimitsDecideWhatIsLeft) {
  ProgressState state = half();
  EXPECT_DOUBLE_EQ(state.fraction(), 0.5);
  EXPECT_DOUBLE_EQ(state.secondsLeft(), 20.0);
  state.secondLimit = 25;
  EXPECT_DOUBLE_EQ(state.fraction(), 0.8);
  EXPECT_DOUBLE_EQ(state.secondsLeft(), 5.0);
  state.seconds = 30;
  EXPECT_DOUBLE_EQ(state.secondsLeft(), 0.0);
  EXPECT_DOUBLE_EQ(state.fraction(), 1.0);
  EXPECT_FALSE(ProgressState{}.secondsLeft() < std::numeric_limits<double>::infinity());
}

TEST(ProgressBar, Line) { EXPECT_EQ(progressLine(half()), "32/64 samples, 12.3 Mrays/s, 20 s, 20 s left"); }

TEST(ProgressBar, TellsTheErrorWhereItIsKnown) {
  ProgressState state = half();
  state.error = 0.0234;
  EXPECT_EQ(progressLine(state), "32/64 samples, 12.3 Mrays/s, error 2.3 %, 20 s, 20 s left");
  state.error = std::numeric_limits<double>::infinity();  // below two batches
  EXPECT_EQ(progressLine(state), progressLine(half()));
}

TEST(ProgressBar, FitsTheTerminal) {
  for (int width = 0; width < 160; ++width)
    EXPECT_LE(progressBar(half(), width, false).size(), static_cast<std::size_t>(width));
  EXPECT_EQ(progressBar(half(), 58, false), "[=====>    ] 32/64 samples  12.3 Mrays/s  20 s  20 s left");
  EXPECT_EQ(progressBar(half(), 58, false).find('\x1b'), std::string::npos);
  EXPECT_NE(progressBar(half(), 58, true).find("\x1b[32m"), std::string::npos);
}

}  // namespace
}  // namespace quintet::app
