// Ctrl-C: the first one writes what there is, the second one leaves at once and leaves nothing.
#include <csignal>

#include "fixtures.h"

namespace quintet::test {
namespace {

class Interrupt : public CliTest {
 protected:
  static std::vector<std::string> endless(const std::string& size) {
    return {"render", "scene.gltf", "--program", "normals", "--size", size, "--time", "100000", "-o", "out.png"};
  }
};

TEST_F(Interrupt, OnceWritesThePicture) {
  TerminalRun process(endless("200x150"), folder_.path());
  ASSERT_TRUE(process.waitFor("Mrays/s"));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_EQ(picture("out.png").width, 200u);
  EXPECT_NE(result.err.find("interrupted"), std::string::npos);
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"out.png", "scene.gltf"}));
}

TEST_F(Interrupt, TerminationDoesTheSame) {
  TerminalRun process(endless("64x48"), folder_.path());
  ASSERT_TRUE(process.waitFor("Mrays/s"));
  process.signal(SIGTERM);
  EXPECT_EQ(process.finish().status, 143);
  EXPECT_EQ(picture("out.png").width, 64u);
}

TEST_F(Interrupt, TwiceLeavesNothing) {
  // Large enough for the batch to be still running when the second signal comes.
  TerminalRun process(endless("3000x3000"), folder_.path());
  ASSERT_TRUE(process.waitFor(" samples"));
  process.signal(SIGINT);
  ASSERT_TRUE(process.waitFor("once more leaves at once"));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_TRUE(result.err.ends_with("quintet: interrupted\r\n")) << result.err;
  EXPECT_EQ(fileNames(), std::vector<std::string>{"scene.gltf"});
}

TEST_F(Interrupt, TheBarRespectsTheTerminal) {
  TerminalRun process(endless("64x48"), folder_.path());
  ASSERT_TRUE(process.waitFor("Mrays/s"));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_NE(result.err.find('['), std::string::npos);
  EXPECT_NE(result.err.find(" left"), std::string::npos);
}

}  // namespace
}  // namespace quintet::test
