// SPDX-License-Identifier: Apache-2.0
// --preview: the image on the terminal of standard error.
#include <algorithm>
#include <csignal>
#include <cstddef>

#include <gmock/gmock.h>

#include "fixtures.h"

namespace quintet::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

class PreviewOption : public CliTest {
 protected:
  // A render that ends after its second image.
  RunResult interrupted(const std::string& option, const std::string& marker,
                        const TerminalRun::Environment& environment = {}) {
    TerminalRun process({"render", "scene.gltf", "--program", "normals", "--size", "32x24", "--time", "100000", "-o",
                         "out.png", option},
                        folder_.path(), 100, environment);
    EXPECT_TRUE(process.waitForNext(marker) && process.waitForNext(marker)) << option;
    process.signal(SIGINT);
    return process.finish();
  }
  static constexpr const char* kBlock = "\u2580";
};

TEST_F(PreviewOption, Kitty) {
  const RunResult result = interrupted("--preview=kitty", "\x1b_Ga=T,q=2,f=24,s=32,v=24,");
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_EQ(readImage("out.png").width, 32u);
  // The last image stays on the terminal.
  EXPECT_GT(result.err.rfind("a=T"), result.err.rfind("a=d")) << result.err;
  EXPECT_THAT(result.err.substr(result.err.rfind("\x1b\\")), HasSubstr("out.png: "));
}

TEST_F(PreviewOption, Sixel) {
  const RunResult result = interrupted("--preview=sixel", "\x1bP0;1q\"1;1;32;24#0;2;");
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_THAT(result.err, Not(HasSubstr("\x1b_G")));
}

TEST_F(PreviewOption, BlocksHaveTheColorsOfTheTerminal) {
  for (const bool trueColor : {false, true}) {
    const RunResult result = interrupted("--preview=blocks", std::string(kBlock) + "\x1b[0m\r",
                                         {{"COLORTERM", trueColor ? "truecolor" : ""}});
    EXPECT_EQ(result.status, 130) << result.err;
    EXPECT_EQ(result.err.find("\x1b[38;2;") != std::string::npos, trueColor) << result.err;
    EXPECT_EQ(result.err.find("\x1b[38;5;") != std::string::npos, !trueColor) << result.err;
    // 24 rows of pixels, drawn again in the same rows.
    EXPECT_EQ(countOf(result.err, "\x1b[0m\r") % 12, 0u);
    EXPECT_THAT(result.err, HasSubstr("\x1b[12A"));
  }
}

// The last image is complete; on a slow machine, there are others before it.
TEST_F(PreviewOption, TheEndIsShown) {
  for (const char* command : {"render", "run"}) {
    std::vector<std::string> arguments{command, "scene.gltf", "--size", "32x24", "--spp", "4", "--preview=blocks"};
    if (std::string(command) == "run") arguments.insert(arguments.begin() + 1, "normals");
    const RunResult result = TerminalRun(arguments, folder_.path()).finish();
    EXPECT_EQ(result.status, 0) << result.err;
    const std::size_t count = countOf(result.err, kBlock);
    EXPECT_GE(count, 32u * 12) << command;
    EXPECT_EQ(count % (32u * 12), 0u) << command;
    EXPECT_GT(result.err.rfind("32x24"), result.err.rfind(kBlock)) << "the image is above the summary";
  }
}

TEST_F(PreviewOption, AutoUsesTheEnvironment) {
  const auto shown = [&](const TerminalRun::Environment& environment) {
    const RunResult result =
        TerminalRun(quick({"--preview", "-o", "out.png"}), folder_.path(), 100, environment).finish();
    EXPECT_EQ(result.status, 0) << result.err;
    return result.err;
  };
  EXPECT_THAT(shown({{"KITTY_WINDOW_ID", "1"}}), HasSubstr("\x1b_Ga=T"));
  EXPECT_THAT(shown({{"TERM", "xterm-ghostty"}}), HasSubstr("\x1b_Ga=T"));
  EXPECT_THAT(shown({{"TERM_PROGRAM", "WezTerm"}}), HasSubstr("\x1bP0;1q"));
  // A terminal that does not answer.
  const std::string blocks = shown({{"KITTY_WINDOW_ID", "1"}, {"TMUX", "session"}});
  EXPECT_THAT(blocks, HasSubstr("\x1b[c"));
  EXPECT_THAT(blocks, HasSubstr(kBlock));
  EXPECT_THAT(blocks, Not(HasSubstr("\x1b_G")));
}

TEST_F(PreviewOption, AutoAsksTheTerminal) {
  for (const bool sixel : {false, true}) {
    TerminalRun process(quick({"--preview=auto", "-o", "out.png"}), folder_.path());
    ASSERT_TRUE(process.waitFor("\x1b[c"));
    process.type(sixel ? "\x1b[?62;4;22c" : "\x1b[?4;22c");  // the first number is no attribute
    const RunResult result = process.finish();
    EXPECT_EQ(result.err.find("\x1bP0;1q") != std::string::npos, sixel) << result.err;
    EXPECT_EQ(result.err.find(kBlock) != std::string::npos, !sixel) << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr("[?"))) << "the terminal shows the answer";
  }
}

TEST_F(PreviewOption, IsOffWhereNothingCanShowIt) {
  const std::vector<std::string> command{"render", "scene.gltf", "--program", "normals", "--size", "8x8", "--spp", "1"};
  const auto with = [&](const std::string& option) {
    std::vector<std::string> arguments = command;
    arguments.push_back(option);
    return arguments;
  };
  const RunResult piped = quintet(with("--preview"));
  EXPECT_EQ(piped.status, 0);
  EXPECT_THAT(piped.err, AllOf(HasSubstr("no preview: "), HasSubstr("not a terminal")));
  EXPECT_THAT(piped.err, Not(HasSubstr("\x1b")));
  expectError(quintet(with("--preview=sixel")), 2, {"--preview=sixel", "not a terminal"});
  EXPECT_THAT(TerminalRun(with("--preview"), folder_.path(), 100, {{"TERM", "dumb"}}).finish().err,
              AllOf(HasSubstr("no preview: "), HasSubstr("cannot show images")));
  const TerminalRun::Environment noColor{{"NO_COLOR", "1"}, {"TMUX", "1"}};
  EXPECT_THAT(TerminalRun(with("--preview"), folder_.path(), 100, noColor).finish().err,
              HasSubstr("no preview: NO_COLOR is set"));
  EXPECT_THAT(TerminalRun(with("--preview=blocks"), folder_.path(), 100, noColor).finish().err, HasSubstr(kBlock));
  EXPECT_THAT(TerminalRun(with("--preview=off"), folder_.path()).finish().err, Not(HasSubstr(kBlock)));
}

TEST_F(PreviewOption, WrongValues) {
  expectError(quintet(quick({"--preview=sixl"})), 2, {"--preview", "'sixl'", "'sixel'"});
  expectError(quintet(quick({"--preview="})), 2, {"--preview: the value is empty"});
  EXPECT_EQ(quintet(quick({"--preview=sixl", "--preview=off"})).status, 0);  // the last one counts
  expectError(quintet(quick({"--preview", "--json-progress"})), 2, {"--json-progress and --preview"});
  // Without the sign, the next argument is not the value.
  expectError(quintet({"run", "normals", "--preview", "a.gltf", "kitty"}), 2, {"unexpected argument 'kitty'"});
}

}  // namespace
}  // namespace quintet::test
