// SPDX-License-Identifier: Apache-2.0
// Ctrl-C: the first one writes the image of the finished batches, the second one ends the process without an image.
#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <regex>
#include <sstream>

#include "fixtures.h"

namespace quintet::test {
namespace {

class Interrupt : public CliTest {
 protected:
  static std::vector<std::string> endless(const std::string& size) {
    return {"render", "scene.gltf", "--program", "normals", "--size", size, "--time", "100000", "-o", "out.png"};
  }
};

TEST_F(Interrupt, TheFirstWritesTheImage) {
  TerminalRun process(endless("200x150"), folder_.path());
  ASSERT_TRUE(process.waitFor("Mrays/s"));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_EQ(readImage("out.png").width, 200u);
  EXPECT_NE(result.err.find("interrupted"), std::string::npos);
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"out.png", "scene.gltf"}));
}

TEST_F(Interrupt, SigtermWritesTheImage) {
  TerminalRun process(endless("64x48"), folder_.path());
  ASSERT_TRUE(process.waitFor("Mrays/s"));
  process.signal(SIGTERM);
  EXPECT_EQ(process.finish().status, 143);
  EXPECT_EQ(readImage("out.png").width, 64u);
}

TEST_F(Interrupt, TheSecondEndsTheProcess) {
  // The image is so large that the batch still runs when the second signal arrives.
  TerminalRun process(endless("3000x3000"), folder_.path());
  ASSERT_TRUE(process.waitFor(" samples"));
  process.signal(SIGINT);
  ASSERT_TRUE(process.waitFor("Ctrl-C again"));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_TRUE(result.err.ends_with("quintet: interrupted\r\n")) << result.err;
  EXPECT_EQ(fileNames(), std::vector<std::string>{"scene.gltf"});
}

// The lines that a terminal shows one after the other, without the escape sequences that delete and color them.
std::vector<std::string> shownLines(const std::string& text) {
  static const std::regex kEscapes("\x1b\\[[0-9;]*[A-Za-z]");
  std::istringstream lines(std::regex_replace(text, kEscapes, ""));
  std::vector<std::string> shown;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream parts(line);
    for (std::string part; std::getline(parts, part, '\r');) shown.push_back(part);
  }
  return shown;
}

TEST_F(Interrupt, TheProgressBarFitsTheTerminal) {
  for (const std::uint16_t columns : {std::uint16_t{100}, std::uint16_t{30}}) {
    TerminalRun process(endless("64x48"), folder_.path(), columns);
    // A terminal without space for a bar shows the start of the numbers.
    ASSERT_TRUE(process.waitFor(columns == 30 ? " samples" : " left"));
    process.signal(SIGINT);
    const RunResult result = process.finish();
    bool hasBar = false;
    for (const std::string& line : shownLines(result.err)) {
      if (line.find(" samples") == std::string::npos || line.find("out.png: ") != std::string::npos) continue;
      EXPECT_LE(line.size(), columns) << line;
      hasBar = hasBar || (line.starts_with('[') && line.find(" left") != std::string::npos);
    }
    EXPECT_EQ(hasBar, columns == 100) << columns << ": " << result.err;
  }
}

TEST_F(Interrupt, TheProgressBarHasColorsUnlessDisabled) {
  for (const bool disabled : {false, true}) {
    disabled ? ::setenv("NO_COLOR", "1", 1) : ::unsetenv("NO_COLOR");
    TerminalRun process(endless("64x48"), folder_.path());
    ::unsetenv("NO_COLOR");
    ASSERT_TRUE(process.waitFor(" left"));
    process.signal(SIGINT);
    EXPECT_EQ(process.finish().err.find("\x1b[32m") == std::string::npos, disabled);
  }
}

// Without a terminal: a line of text every ten seconds.
TEST_F(Interrupt, ProgressIsALineOfTextWithoutATerminal) {
  const RunResult result = quintet({"render", "scene.gltf", "--program", "normals", "--size", "64x48", "--env", "none",
                                    "--time", "11", "-o", "out.png"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(std::regex_search(
      result.err,
      std::regex("(^|\n)[0-9]+ samples, [0-9.e+]+ Mrays/s(, error [0-9.e-]+ %)?, [0-9.]+ s, [0-9.]+ s left\n")))
      << result.err;
  EXPECT_EQ(result.err.find('\x1b'), std::string::npos);
  EXPECT_GE(std::count(result.err.begin(), result.err.end(), '\n'), 2) << result.err;  // with the summary
}

}  // namespace
}  // namespace quintet::test
