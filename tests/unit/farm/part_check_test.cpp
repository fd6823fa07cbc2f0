// SPDX-License-Identifier: Apache-2.0
// Parts of a plan: every way in which one can be unusable is found and named, and the usable ones are merged to the film
// that a simple merge gives.
#include "farm/part_check.h"

#include <gmock/gmock.h>

#include <chrono>
#include <future>
#include <optional>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/file.h"
#include "base/file_lock.h"
#include "farm/part_failure.h"
#include "farm/part_lock.h"
#include "farm/part_merge.h"
#include "farm/plans.h"
#include "farm/status.h"
#include "temp_folder.h"

#include <nlohmann/json.hpp>

namespace quintet::farm {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class FarmParts : public testing::Test {
 protected:
  FarmParts() {
    for (std::size_t part = 0; part < plan_.parts.size(); ++part) test::writePart(plan_, part);
  }
  PartState stateOf(std::size_t part, CheckDepth depth = CheckDepth::header) const {
    return checkPart(plan_, part, depth).state;
  }
  std::string problemOf(std::size_t part) const { return checkPart(plan_, part, CheckDepth::content).problem; }
  std::string mergeError(bool partial = false) {
    try {
      mergeParts(plan_, partial, observer_, "", 0);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  void changeByte(std::size_t part, std::size_t fromEnd) const {
    std::vector<std::byte> bytes = readFile(partFile(plan_, part));
    bytes[bytes.size() - fromEnd] ^= std::byte{1};
    writeFile(partFile(plan_, part), bytes);
  }

  const quintet::test::TempFolder folder_;
  const Plan plan_ = test::makePlan(folder_.path(), 4);
  job::test::RecordingObserver observer_;
};

// The oracle reads all films and merges them in memory.
TEST_F(FarmParts, MergeToTheSameFilmAsAllFilmsInMemory) {
  render::FilmFile expected = render::readFilm(partFile(plan_, 0));
  for (std::size_t part = 1; part < plan_.parts.size(); ++part)
    render::mergeFilm(expected.film, render::readFilm(partFile(plan_, part)).film);
  const job::RenderResult merged = mergeParts(plan_, false, observer_, "quintet farm merge", 0);
  render::FilmFile found = job::filmFileOf(merged);
  EXPECT_EQ(found.film.counts.ranges, (std::vector<render::SampleRange>{{0, 16}}));
  EXPECT_EQ(merged.provenance.farmPlan, planId(plan_));
  found.notes = expected.notes = {};
  EXPECT_EQ(render::encodeFilm(found), render::encodeFilm(expected));
}

TEST_F(FarmParts, AreDone) {
  for (std::size_t part = 0; part < plan_.parts.size(); ++part)
    EXPECT_EQ(stateOf(part, CheckDepth::content), PartState::done) << problemOf(part);
  EXPECT_TRUE(unexpectedFiles(plan_).empty());
}

TEST_F(FarmParts, OneErrorNamesAllProblems) {
  std::filesystem::remove(partFile(plan_, 0));
  recordFailure(plan_, 0, {"node7", "disk full", 1});
  test::writePart(plan_, 1, [](job::Provenance& p) { p.version = "0.0.9"; });
  test::writePart(plan_, 2, [](job::Provenance& p) { p.farmPlan = std::string(32, 'e'); });
  std::filesystem::copy_file(partFile(plan_, 3), folder_ / "parts/000/extra.qfilm");
  EXPECT_EQ(stateOf(0), PartState::missing);
  EXPECT_EQ(stateOf(1), PartState::wrongVersion);
  EXPECT_EQ(stateOf(2), PartState::foreign);
  EXPECT_THAT(mergeError(), AllOf(HasSubstr("1 of 4 parts usable"),
                                  HasSubstr("part 0 (batch 0) is missing: failed on "
                                            "node7 with status 1: disk full"),
                                  HasSubstr("part 1 (batch 1) has the wrong version"), HasSubstr("0.0.9"),
                                  HasSubstr("part 2 (batch 2) is foreign"), HasSubstr("eeeeeeeeeeee, expected"),
                                  HasSubstr("extra.qfilm: is not a part of this plan"), Not(HasSubstr("part 3"))));
}

TEST_F(FarmParts, KilledProcessesLeaveARecord) {
  std::filesystem::remove(partFile(plan_, 0));
  recordFailure(plan_, 0, {"node7", "", 0});
  EXPECT_EQ(problemOf(0), "started on node7 and not finished");
  removeFailure(plan_, 0);
  EXPECT_EQ(problemOf(0), "");
}

TEST_F(FarmParts, CopiesOfOtherPartsAreForeign) {
  std::filesystem::copy_file(partFile(plan_, 1), partFile(plan_, 2), std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(stateOf(2), PartState::foreign);
  EXPECT_THAT(mergeError(), AllOf(HasSubstr("holds samples 4–7, expected samples 8–11; it is a copy of part 1")));
}

TEST_F(FarmParts, DamageBehindTheHeaderIsFoundWhileMerging) {
  changeByte(1, 40);
  changeByte(3, 1);
  EXPECT_EQ(stateOf(1), PartState::done) << "only the header is read";
  EXPECT_EQ(stateOf(1, CheckDepth::content), PartState::damaged);
  EXPECT_THAT(mergeError(), AllOf(HasSubstr("2 of 4 parts usable"), HasSubstr("part 1 (batch 1) is damaged"),
                                  HasSubstr("part 3 (batch 3) is damaged"), HasSubstr("checksum")));
  std::filesystem::resize_file(partFile(plan_, 2), 100);
  EXPECT_EQ(stateOf(2), PartState::damaged);
  EXPECT_THAT(mergeError(true), HasSubstr("part 2 (batch 2) is damaged")) << "damage is no missing part";
}

TEST_F(FarmParts, InterruptedPartsAreIncomplete) {
  const Plan halves = [&] {
    Plan plan = plan_;
    plan.parts = splitWork(0, 3, 2, "batch", "batches");
    return plan;
  }();
  job::Provenance p = job::test::makeProvenance();
  p.farmPlan = planId(halves);
  render::writeFilm(partFile(halves, 1), job::test::makeFilmFile(p, {{8, 12}}));
  const PartCheck check = checkPart(halves, 1, CheckDepth::header);
  EXPECT_EQ(check.state, PartState::incomplete);
  EXPECT_THAT(check.problem, HasSubstr("holds samples 8–11, expected samples 8–15"));
}

TEST_F(FarmParts, PartialMergesSkipMissingParts) {
  std::filesystem::remove(partFile(plan_, 1));
  EXPECT_THAT(mergeError(), HasSubstr("3 of 4 parts usable; part 1 (batch 1) is missing"));
  EXPECT_EQ(mergeParts(plan_, true, observer_, "", 0).film->counts().ranges,
            (std::vector<render::SampleRange>{{0, 4}, {8, 16}}));
  for (std::size_t part = 0; part < plan_.parts.size(); ++part) std::filesystem::remove(partFile(plan_, part));
  EXPECT_THAT(mergeError(true), HasSubstr("no part is done"));
}

TEST_F(FarmParts, DeviceCountSurvivesTheMerge) {
  test::writePart(plan_, 2, [](job::Provenance& p) { p.deviceCount = 4; });
  test::writePart(plan_, 3, [](job::Provenance& p) { p.deviceCount = 2; });
  EXPECT_EQ(mergeParts(plan_, false, observer_, "", 0).provenance.deviceCount, 4u);
}

TEST_F(FarmParts, StatusCountsAndLists) {
  std::filesystem::remove(partFile(plan_, 1));
  changeByte(2, 10);
  Status status = readStatus(plan_, CheckDepth::content);
  status.slurm.job = "12";
  status.slurm.problem = "squeue was not found, so the states of the jobs are unknown";
  status.slurm.tasks[1] = {"RUNNING", "node2"};
  status.tasks = 4;
  const std::string text = statusText(status);
  EXPECT_THAT(text, AllOf(HasSubstr("2 of 4 parts done, 1 missing, 1 damaged\n"), HasSubstr("part 1 (batch 1)"),
                          HasSubstr("RUNNING on node2"), HasSubstr("squeue was not found")));
  const nlohmann::json json = nlohmann::json::parse(statusJson(status));
  EXPECT_EQ(json["states"]["done"], 2);
  EXPECT_EQ(json["complete"], false);
  ASSERT_EQ(json["notDone"].size(), 2u);
  EXPECT_EQ(json["notDone"][0]["slurm"]["nodes"], "node2");
  EXPECT_EQ(json["notDone"][1]["state"], "damaged");
  EXPECT_THAT(statusText(status, 1), HasSubstr("and 1 more"));
}

TEST_F(FarmParts, AreRenderedByOneProcessAtATime) {
  std::optional<FileLock> lock(std::in_place, checkpointFile(plan_, 1));
  EXPECT_THROW(waitUntilFree(plan_, 1, 0.0), FileError);
  waitUntilFree(plan_, 0, 0.0);
  const std::future<void> release = std::async(std::launch::async, [&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    lock.reset();
  });
  waitUntilFree(plan_, 1, 20.0);
  EXPECT_FALSE(lock.has_value());
}

TEST(SlurmTaskLines, AreRead) {
  SlurmTasks tasks;
  readTaskLines("12_0|RUNNING|n1\n12_1|PENDING|\nnonsense\n13|PENDING|\n99_1|RUNNING|n9\n12_x|RUNNING|n1\n", "12", "13",
                tasks);
  // Of accounts: known tasks keep their state.
  readTaskLines("12_0|FAILED|n1\n12_2|TIMEOUT by 1000|None assigned\n", "12", "13", tasks);
  ASSERT_EQ(tasks.tasks.size(), 3u);
  EXPECT_EQ(tasks.tasks[0].state, "RUNNING");
  EXPECT_EQ(tasks.tasks[1].nodes, "");
  EXPECT_EQ(tasks.tasks[2].state, "TIMEOUT");
  EXPECT_EQ(tasks.tasks[2].nodes, "");
  ASSERT_TRUE(tasks.merge);
  EXPECT_EQ(tasks.merge->state, "PENDING");
}

class FarmFrames : public testing::Test {
 protected:
  FarmFrames() {
    plan_.kind = PartKind::frames;
    plan_.parts = splitWork(10, 13, 2, "frame", "frames");
    for (std::size_t part = 0; part < 2; ++part) writeFrameList(plan_, part, framesOf(part));
  }
  std::vector<WrittenFrame> framesOf(std::size_t part) {
    std::vector<WrittenFrame> frames;
    for (std::uint64_t f = plan_.parts[part].first; f <= plan_.parts[part].last; ++f) {
      const std::filesystem::path image = folder_ / ("f" + std::to_string(f) + ".png");
      writeFile(image, "image " + std::to_string(f));
      frames.push_back({f, {image}});
    }
    return frames;
  }
  PartCheck check(std::size_t part, CheckDepth depth = CheckDepth::content) { return checkPart(plan_, part, depth); }

  const quintet::test::TempFolder folder_;
  Plan plan_ = test::makePlan(folder_.path(), 2);
};

TEST_F(FarmFrames, AreVerified) {
  EXPECT_EQ(check(0).state, PartState::done) << check(0).problem;
  EXPECT_EQ(check(1).state, PartState::done);
  writeFile(folder_ / "f11.png", "image 1x");  // the same size
  EXPECT_EQ(check(0, CheckDepth::header).state, PartState::done);
  EXPECT_EQ(check(0).state, PartState::damaged);
  writeFile(folder_ / "f11.png", "short");
  EXPECT_EQ(check(0, CheckDepth::header).state, PartState::damaged);
  std::filesystem::remove(folder_ / "f11.png");
  EXPECT_EQ(check(0).state, PartState::incomplete);
  EXPECT_THAT(check(0).problem, HasSubstr("f11.png: is missing"));
}

TEST_F(FarmFrames, ListsMustFitThePart) {
  std::vector<WrittenFrame> frames = framesOf(0);
  frames.pop_back();
  writeFrameList(plan_, 0, frames);
  EXPECT_THAT(check(0).problem, HasSubstr("frame 11 is missing"));
  std::filesystem::copy_file(partFile(plan_, 1), partFile(plan_, 0), std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(check(0).problem, HasSubstr("is a copy of part 1"));
  writeFile(partFile(plan_, 0), "{");
  EXPECT_EQ(check(0).state, PartState::damaged);
  Plan other = plan_;
  other.samples = 99;
  writeFrameList(other, 0, framesOf(0));
  EXPECT_EQ(check(0).state, PartState::foreign);
}

}  // namespace
}  // namespace quintet::farm
