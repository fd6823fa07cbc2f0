// SPDX-License-Identifier: Apache-2.0
// The check of several programs: which ones, in which order, and what the report has of each.
#include "job/program_checks.h"

#include <gmock/gmock.h>

#include "program_folder.h"

namespace quintet::job {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

class ProgramChecksTest : public testing::Test {
 protected:
  ProgramChecksTest() { writeProgram(program_); }
  CheckReport check(const CheckRequest& request) { return ProgramChecks(request, {}).run(recorder_); }

  const quintet::test::TempFolder folder_;
  const std::string program_ = folder_ / "good";
  CheckRecorder recorder_;
};

TEST_F(ProgramChecksTest, FoldersStandForTheirPrograms) {
  writeProgram(folder_ / "deep" / "er");
  writeProgram(folder_ / ".hidden");
  writeFile(folder_ / "a.rt.glsl", "");
  std::filesystem::create_directory(folder_ / "empty");
  std::filesystem::create_directory_symlink(program_, folder_ / "link");
  const std::string all = folder_.path(), empty = folder_ / "empty";
  EXPECT_THAT(findPrograms({"ao", all}), ElementsAre("ao", all + "/a.rt.glsl", all + "/deep/er", all + "/good"));
  EXPECT_THAT(findPrograms({program_, empty}), ElementsAre(program_, empty));
}

TEST_F(ProgramChecksTest, ReportsEachProgramInOrder) {
  const std::string bad = folder_ / "bad", broken = folder_ / "broken";
  writeProgram(bad);
  edit(bad + "/sky.rmiss", "payload.t", "payload.u");
  writeProgram(broken);
  edit(broken + "/program.toml", "main.rgen", "man.rgen");
  const CheckReport report = check(requestFor({broken, program_, bad}));
  EXPECT_THAT(recorder_.events, ElementsAre("started " + broken, "finished " + broken, "started " + program_,
                                            "finished " + program_, "started " + bad, "finished " + bad));
  EXPECT_THAT(idsOf(report), ElementsAre("FILE program.toml", "GLSL sky.rmiss"));
  EXPECT_FALSE(report.programs[0].program);
  EXPECT_THAT(report.programs[1].result.diagnostics, IsEmpty());
  EXPECT_TRUE(report.sources()(bad + "/sky.rmiss"));
}

TEST_F(ProgramChecksTest, WarningsCountOnRequest) {
  EXPECT_TRUE(check(requestFor({program_})).passes(true));
  edit(program_ + "/main.rgen", "0xFFu", "0x1FFu");
  const CheckReport warned = check(requestFor({program_}));
  EXPECT_THAT(idsOf(warned), ElementsAre("Q505 main.rgen"));
  EXPECT_TRUE(warned.passes(false));
  EXPECT_FALSE(warned.passes(true));
  edit(program_ + "/main.rgen", "  traceRayEXT", "  // quintet: allow Q505 the low bits count\n  traceRayEXT");
  const CheckReport suppressed = check(requestFor({program_}));
  EXPECT_TRUE(suppressed.passes(true));
  EXPECT_EQ(suppressed.suppressed().size(), 1u);
}

TEST_F(ProgramChecksTest, UsesTheRequestedScene) {
  CheckRequest request = requestFor({program_});
  EXPECT_FALSE(check(request).programs[0].facts);
  request.scene = folder_ / "a.scene.toml";
  EXPECT_THAT(idsOf(check(request)), ElementsAre("FILE a.scene.toml"));
  writeFile(request.scene, "[[mesh]]\nname = \"quad\"\nshape = \"quad\"\n[[instance]]\nof = \"quad\"\n");
  const CheckReport report = check(request);
  ASSERT_TRUE(report.programs[0].facts);
  EXPECT_EQ(report.programs[0].facts->geometries.size(), 1u);
  EXPECT_THAT(report.programs[0].files, Contains(request.scene));
}

TEST_F(ProgramChecksTest, UnknownProgramsDoNotEndTheCheck) {
  const CheckReport report = check(requestFor({"nothing", program_}));
  ASSERT_EQ(report.programs.size(), 2u);
  EXPECT_THAT(idsOf(report), ElementsAre(" nothing"));
  EXPECT_TRUE(report.wrongRequest());
  EXPECT_FALSE(report.passes(false));
  EXPECT_TRUE(report.programs[1].program);
  EXPECT_FALSE(check(requestFor({program_})).wrongRequest());
}

TEST_F(ProgramChecksTest, DescribesPipelinesThatCompile) {
  const ProgramChecks checks(requestFor({program_}), {});
  const std::optional<check::PipelineModel> model = checks.pipelineOf(checks.run(recorder_).programs[0]);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->traces.size(), 2u);
  edit(program_ + "/sky.rmiss", "payload.t", "payload.u");
  EXPECT_FALSE(checks.pipelineOf(checks.run(recorder_).programs[0]));
  edit(program_ + "/program.toml", "main.rgen", "man.rgen");
  EXPECT_FALSE(checks.pipelineOf(checks.run(recorder_).programs[0]));
}

}  // namespace
}  // namespace quintet::job
