// SPDX-License-Identifier: Apache-2.0
// The check follows the files on disk: which ones it depends on, and what it reports after a save.
#include "job/live_check.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "program_folder.h"

namespace quintet::job {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kLong = 10.0;  // seconds to wait for an expected change

class LiveCheckTest : public testing::Test {
 protected:
  LiveCheckTest() { writeProgram(program_); }

  // Waits for a save of one file, and checks again.
  std::vector<std::string> checkAfterSave(LiveCheck& live, const std::string& name) {
    live.watcher().wait(kLong);
    EXPECT_EQ(live.watcher().changedNames(), name);
    return idsOf(live.run(recorder_));
  }

  const quintet::test::TempFolder folder_;
  const fs::path program_ = folder_ / "demo";
  const ProgramChecks checks_{requestFor({program_}), {}};
  CheckRecorder recorder_;
};

TEST_F(LiveCheckTest, ReportsWhatASaveChanges) {
  LiveCheck live(checks_);
  EXPECT_THAT(idsOf(live.run(recorder_)), IsEmpty());
  EXPECT_FALSE(live.watcher().pending());
  edit(program_ / "main.rgen", "0xFFu", "0x1FFu");
  EXPECT_TRUE(live.watcher().pending());
  EXPECT_THAT(checkAfterSave(live, "main.rgen"), ElementsAre("Q505 main.rgen"));
  EXPECT_GE(live.watcher().secondsSinceChange(), 0.0);
  edit(program_ / "main.rgen", "0x1FFu", "0xFFu");
  EXPECT_THAT(checkAfterSave(live, "main.rgen"), IsEmpty());
}

TEST_F(LiveCheckTest, ABrokenDescriptionCanBeRepaired) {
  LiveCheck live(checks_);
  live.run(recorder_);
  edit(program_ / "program.toml", "[program]", "[program");
  EXPECT_THAT(checkAfterSave(live, "program.toml"), ElementsAre("FILE program.toml"));
  edit(program_ / "program.toml", "[program", "[program]");
  EXPECT_THAT(checkAfterSave(live, "program.toml"), IsEmpty());
}

TEST_F(LiveCheckTest, ASaveBeforeTheFirstCheckCounts) {
  LiveCheck live(checks_);
  edit(program_ / "main.rgen", "0xFFu", "0x1FFu");
  EXPECT_TRUE(live.watcher().pending());
}

TEST_F(LiveCheckTest, WatchesIncludedFilesOutsideOfTheProgram) {
  const fs::path shared = folder_ / "shared.glsl";
  writeFile(shared, "const float kMiss = -1.0;\n");
  edit(program_ / "sky.rmiss", "payload.t = -1.0", "payload.t = kMiss");
  edit(program_ / "sky.rmiss", "struct Payload", "#include \"../shared.glsl\"\nstruct Payload");
  LiveCheck live(checks_);
  EXPECT_THAT(idsOf(live.run(recorder_)), IsEmpty());
  // The cause of an error in the program can be in the file outside.
  edit(shared, "kMiss", "kOther");
  EXPECT_THAT(checkAfterSave(live, "shared.glsl"), ElementsAre("GLSL sky.rmiss"));
  edit(shared, "kOther", "kMiss");
  EXPECT_THAT(checkAfterSave(live, "shared.glsl"), IsEmpty());
}

TEST_F(LiveCheckTest, WatchesNewFilesOfTheFolder) {
  edit(program_ / "sky.rmiss", "struct Payload", "#include \"new.glsl\"\nstruct Payload");
  LiveCheck live(checks_);
  // The error, and a note that lists the searched folders.
  EXPECT_THAT(idsOf(live.run(recorder_)), ElementsAre("GLSL sky.rmiss", "GLSL sky.rmiss"));
  writeFile(program_ / "new.glsl", "\n");
  EXPECT_THAT(checkAfterSave(live, "new.glsl"), IsEmpty());
  writeFile(program_ / "image.png", "");
  EXPECT_FALSE(live.watcher().pending());
}

TEST_F(LiveCheckTest, WatchesTheScene) {
  CheckRequest request = requestFor({program_});
  request.scene = folder_ / "a.scene.toml";
  const std::string quad = "[[mesh]]\nname = \"quad\"\nshape = \"quad\"\n[[instance]]\nof = \"quad\"\n";
  writeFile(request.scene, quad);
  const ProgramChecks checks(request, {});
  LiveCheck live(checks);
  live.run(recorder_);
  writeFile(request.scene, "nonsense");
  EXPECT_THAT(checkAfterSave(live, "a.scene.toml"), ElementsAre("FILE a.scene.toml"));
  writeFile(request.scene, quad);
  EXPECT_THAT(checkAfterSave(live, "a.scene.toml"), testing::Not(Contains("FILE a.scene.toml")));
}

TEST_F(LiveCheckTest, ARemovedProgramCanReturn) {
  LiveCheck live(checks_);
  live.run(recorder_);
  fs::remove_all(program_);
  EXPECT_THAT(live.watcher().wait(kLong), testing::Not(IsEmpty()));
  EXPECT_THAT(idsOf(live.run(recorder_)), ElementsAre("FILE demo"));
  writeProgram(folder_ / "new");
  fs::rename(folder_ / "new", program_);
  EXPECT_THAT(live.watcher().wait(kLong), testing::Not(IsEmpty()));
  EXPECT_THAT(idsOf(live.run(recorder_)), IsEmpty());
}

}  // namespace
}  // namespace quintet::job
