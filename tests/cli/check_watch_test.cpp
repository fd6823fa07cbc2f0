// SPDX-License-Identifier: Apache-2.0
// `check --watch` as a process without a terminal. tests/unit/job/live_check_test.cpp has what it reports after a save.
#include <csignal>

#include "base/file.h"
#include "sky_program.h"

namespace quintet::test {
namespace {

class CheckWatch : public CliTest {
 protected:
  CheckWatch() { writeSkyProgram(folder_ / "sky", "payload.color = vec3(0.5);"); }
  void saveSky(const std::string& line) { write(folder_ / "sky" / "sky.rmiss", skyMiss(line)); }
};

TEST_F(CheckWatch, ChecksAgainAfterASave) {
  PipeRun process({"check", "sky", "--watch", "--device", "none"}, {.folder = folder_.path()});
  ASSERT_TRUE(process.waitForNext("sky: clean\n"));
  ASSERT_TRUE(process.waitForNext("watching 4 files; press Ctrl-C to stop\n"));
  saveSky("payload.tint = vec3(0.5);");
  ASSERT_TRUE(process.waitForNext("sky.rmiss saved\n"));
  ASSERT_TRUE(process.waitForNext("sky/sky.rmiss:6:11: error: "));
  ASSERT_TRUE(process.waitForNext("sky: 1 error\n"));
  ASSERT_TRUE(process.waitForNext("watching"));
  process.signal(SIGINT);
  EXPECT_EQ(process.finish().status, 1);
}

TEST_F(CheckWatch, EndsWithTheStatusOfTheLastCheck) {
  saveSky("payload.tint = vec3(0.5);");
  const std::filesystem::path out = folder_ / "out.txt";
  PipeRun process({"check", "sky", "--watch", "--device", "none", "--json"}, {.folder = folder_.path(), .out = out});
  ASSERT_TRUE(process.waitForNext("watching"));
  EXPECT_EQ(nlohmann::json::parse(readTextFile(out))[0]["line"], 6);
  saveSky("payload.color = vec3(0.5);");
  ASSERT_TRUE(process.waitForNext("watching"));
  process.signal(SIGTERM);
  EXPECT_EQ(process.finish().status, 0);
  EXPECT_TRUE(readTextFile(out).ends_with("\n[]\n"));
}

TEST_F(CheckWatch, ContinuesWithoutTheProgram) {
  PipeRun process({"check", "sky", "--watch", "--device", "none"}, {.folder = folder_.path()});
  ASSERT_TRUE(process.waitForNext("watching"));
  std::filesystem::remove_all(folder_ / "sky");
  ASSERT_TRUE(process.waitForNext("sky: error: unknown program 'sky'"));
  ASSERT_TRUE(process.waitForNext("watching"));
  writeSkyProgram(folder_ / "new", "payload.color = vec3(0.5);");
  std::filesystem::rename(folder_ / "new", folder_ / "sky");
  ASSERT_TRUE(process.waitForNext("sky: clean\n"));
}

}  // namespace
}  // namespace quintet::test
