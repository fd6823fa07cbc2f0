// SPDX-License-Identifier: Apache-2.0
// Edits of a large program: what is shown first, and what the complete program renders.
#include "job/program_draft.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "job/films.h"
#include "job/interactive/session.h"
#include "job/render_job.h"
#include "job/test_engine.h"
#include "program/load.h"
#include "program/new_program.h"
#include "temp_folder.h"

namespace quintet::job {
namespace {

// A copy of the path tracer, whose ray generation shader is edited.
class ProgramDraft : public testing::Test {
 protected:
  ProgramDraft() {
    writeFile(folder_ / "a.scene.toml",
              "[[mesh]]\nname = \"box\"\nshape = \"cube\"\n[[instance]]\nof = \"box\"\n"
              "[[camera]]\nlook_from = [1, 2, 8]\nlook_at = [0, 0, 0]\n[environment]\ncolor = [0.1, 0.2, 0.3]\n");
    program::createProgram(program::planNewProgram({.name = name(), .from = "pathtracer"}));
  }

  // Without caches on disk: what a test compiles, another test does not find.
  static bool isSoftware() { return testEngine().context().info().software; }
  std::string name() const { return (folder_ / "copy").string(); }

  void edit(const std::string& statement) {
    const std::filesystem::path file = folder_ / "copy" / "pathtracer.rgen";
    std::string text = readTextFile(file);
    const std::string main = "void main() {";
    ASSERT_NE(text.find(main), std::string::npos);
    writeFile(file, text.insert(text.find(main) + main.size(), " " + statement));
  }

  RenderRequest request() const {
    RenderRequest request;
    request.scene = folder_ / "a.scene.toml";
    request.size = {40, 24};
    request.limits.samples = 4;
    return request;
  }
  std::unique_ptr<RenderJob> editableJob() {
    RenderRequest editable = request();
    editable.editable = true;
    return std::make_unique<RenderJob>(testEngine(), resolve(editable, program::loadProgram(name())), observer_);
  }
  void setDraft(RenderJob& job) { job.setProgram(program::loadProgram(name()), {.draft = true}, observer_); }
  static std::vector<shared::FixedSum> sums(const RenderResult& result) { return result.film->plane(0).sums; }
  std::vector<shared::FixedSum> reference() {
    RenderJob job(testEngine(), resolve(request(), program::loadProgram(name())), observer_);
    return sums(job.run(request().limits, observer_));
  }

  const quintet::test::TempFolder folder_;
  Observer observer_;
};

// The statement changes the code, but not the image: no compiler knows that no pixel has this index.
constexpr const char* kUnusedReturn = "if (gl_LaunchIDEXT.x == 1234567u) return;";
// The program has no miss shader of this index.
constexpr const char* kMistake =
    "traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, kRayTypeCount, 77u, vec3(0.0), 0.0, vec3(0.0, 0.0, 1.0), 1.0, 0);";

TEST_F(ProgramDraft, TheCompleteProgramRendersTheSameBits) {
  const auto job = editableJob();
  EXPECT_FALSE(job->showsDraft()) << "the first program is complete";
  edit(kUnusedReturn);
  setDraft(*job);
  EXPECT_EQ(job->showsDraft(), isSoftware());
  ASSERT_TRUE(job->renderBatch(4, observer_));
  EXPECT_EQ(job->sampleCount(), 4) << "the draft renders";
  const std::uint64_t links = job->linkCount();
  job->completeProgram(observer_);
  EXPECT_FALSE(job->showsDraft());
  // On a GPU there is no draft, so nothing is replaced.
  EXPECT_EQ(job->sampleCount(), isSoftware() ? 0 : 4) << "samples of the draft are discarded";
  EXPECT_EQ(job->linkCount(), links + (isSoftware() ? 1 : 0));
  if (isSoftware()) {
    ASSERT_TRUE(job->renderBatch(4, observer_));
  }
  EXPECT_TRUE(test::equalSums(sums(job->result()), reference()));
}

TEST_F(ProgramDraft, ThereIsNoneOfACompiledProgram) {
  edit(kUnusedReturn);
  const auto job = editableJob();
  setDraft(*job);
  EXPECT_FALSE(job->showsDraft());
}

TEST_F(ProgramDraft, OtherLinksAreComplete) {
  const auto job = editableJob();
  edit(kUnusedReturn);
  setDraft(*job);
  job->setProgram(program::loadProgram(name()), {}, observer_);
  EXPECT_FALSE(job->showsDraft());
  edit("if (gl_LaunchIDEXT.x == 7654321u) return;");
  setDraft(*job);
  job->releaseDevice();
  EXPECT_FALSE(job->showsDraft());
  ASSERT_TRUE(job->renderBatch(4, observer_));
  EXPECT_TRUE(test::equalSums(sums(job->result()), reference()));
}

// Nothing of a program that the check rejects is shown, and a draft that was shown before can still be completed.
TEST_F(ProgramDraft, TheCheckComesFirst) {
  const auto job = editableJob();
  edit(kUnusedReturn);
  setDraft(*job);
  const auto expected = reference();
  edit(kMistake);
  EXPECT_THROW(setDraft(*job), ProgramError);
  EXPECT_EQ(job->showsDraft(), isSoftware());
  job->completeProgram(observer_);
  ASSERT_TRUE(job->renderBatch(4, observer_));
  EXPECT_TRUE(test::equalSums(sums(job->result()), expected));
}

// The first images after an edit come from the draft; the refined image is that of a render.
TEST_F(ProgramDraft, SessionsReplaceItBeforeTheyRefine) {
  double now = 0;
  interactive::SessionRequest session{.program = name(), .render = request(), .drafts = true};
  interactive::Session shown(
      testEngine(), session, [&] { return now; }, observer_);
  shown.refine();
  EXPECT_TRUE(shown.hasFullSize());
  edit(kUnusedReturn);
  std::vector<interactive::Event> events = shown.step(0);
  const auto has = [&]<class Event>() {
    return std::ranges::any_of(events, [](const auto& event) { return std::holds_alternative<Event>(event); });
  };
  EXPECT_TRUE(has.operator()<interactive::ProgramReloaded>());
  EXPECT_TRUE(has.operator()<interactive::ImageUpdated>());
  EXPECT_FALSE(shown.hasFullSize());
  events = shown.refine();
  EXPECT_TRUE(has.operator()<interactive::ImageUpdated>());
  EXPECT_TRUE(shown.hasFullSize());
  EXPECT_TRUE(test::equalSums(sums(shown.result()), reference()));
}

class SavedProgram : public ProgramDraft {};

// An edit does not wait for samples that it discards.
TEST_F(SavedProgram, InterruptsSteps) {
  interactive::SessionRequest session{.program = "normals", .render = request()};
  program::createProgram(
      program::planNewProgram({.name = (folder_ / "own").string(), .from = "normals", .folder = true}));
  session.program = (folder_ / "own").string();
  session.render.limits.samples = 1u << 20;
  double now = 0;
  interactive::Session shown(
      testEngine(), session, [&] { return now; }, observer_);
  int questions = 0;
  const auto interrupted = [&] {
    if (++questions == 3) writeFile(folder_ / "own" / "program.toml", readTextFile(folder_ / "own" / "program.toml"));
    return questions > 1000;
  };
  now = 1;
  shown.step(1e9, interrupted);
  EXPECT_LT(questions, 100);
  const std::vector<interactive::Event> events = shown.step(0);
  EXPECT_TRUE(std::ranges::any_of(
      events, [](const auto& event) { return std::holds_alternative<interactive::ProgramReloaded>(event); }));
}

}  // namespace
}  // namespace quintet::job
