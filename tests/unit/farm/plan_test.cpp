// SPDX-License-Identifier: Apache-2.0
// Plans: how work is split, what the file keeps, and what is rejected.
#include "farm/plan.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/parse.h"
#include "base/text.h"
#include "farm/plans.h"
#include "farm/scripts.h"
#include "job/version.h"
#include "shader/library.h"
#include "temp_folder.h"

namespace quintet::farm {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string messageOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(FarmSplit, CoversTheWorkEvenly) {
  EXPECT_THAT(splitWork(0, 9, 3, "batch", "batches"), ElementsAre(Part{0, 2}, Part{3, 5}, Part{6, 9}));
  EXPECT_THAT(splitWork(5, 5, 1, "frame", "frames"), ElementsAre(Part{5, 5}));
  for (const std::uint64_t count : {1u, 7u, 999u, 1000u}) {
    const std::vector<Part> parts = splitWork(100, 1099, count, "frame", "frames");
    ASSERT_EQ(parts.size(), count);
    std::uint64_t next = 100, least = 1000, most = 0;
    for (const Part& part : parts) {
      EXPECT_EQ(part.first, next);
      next = part.last + 1;
      least = std::min(least, part.last - part.first + 1);
      most = std::max(most, part.last - part.first + 1);
    }
    EXPECT_EQ(next, 1100u);
    EXPECT_LE(most - least, 1u);
  }
}

TEST(FarmSplit, RejectsTooManyParts) {
  EXPECT_THAT(messageOf([] { splitWork(0, 15, 17, "batch", "batches"); }),
              AllOf(HasSubstr("17 parts"), HasSubstr("16 batches")));
  EXPECT_THAT(messageOf([] { splitWork(0, 15, 0, "batch", "batches"); }), HasSubstr("at least 1"));
  EXPECT_THAT(messageOf([] { splitWork(0, 1u << 24, 1'000'001, "batch", "batches"); }), HasSubstr("1000000"));
}

class FarmPlan : public testing::Test {
 protected:
  std::string errorFor(const std::string& text) const {
    writeFile(folder_ / kPlanFile, text);
    return messageOf([&] { readPlan(folder_.path()); });
  }
  const quintet::test::TempFolder folder_;
  Plan plan_ = test::makePlan(folder_.path(), 3);
};

TEST_F(FarmPlan, IsReadBack) {
  writePlan(plan_, {.program = "/bin/quintet"}, false);
  for (const std::filesystem::path& path : {folder_.path(), folder_ / kPlanFile}) {
    const Plan read = readPlan(path);
    EXPECT_EQ(planText(read), planText(plan_));
    EXPECT_EQ(read.folder, folder_.path());
    EXPECT_EQ(read.options, plan_.options);
    EXPECT_EQ(read.parts, plan_.parts);
  }
}

TEST_F(FarmPlan, IdDependsOnEverythingButTheFolder) {
  const std::string id = planId(plan_);
  EXPECT_EQ(id.size(), 32u);
  const std::vector<std::function<void(Plan&)>> changes{[](Plan& p) { p.version = "9"; },
                                                        [](Plan& p) { p.libraryHash[0] = '0'; },
                                                        [](Plan& p) { p.scene = "/b.glb"; },
                                                        [](Plan& p) { p.sceneHash[0] = '0'; },
                                                        [](Plan& p) { p.environmentHash = ""; },
                                                        [](Plan& p) { p.programHash = ""; },
                                                        [](Plan& p) { p.options.push_back("-x"); },
                                                        [](Plan& p) { p.workingFolder = "/"; },
                                                        [](Plan& p) { p.image = "/b.png"; },
                                                        [](Plan& p) { p.kind = PartKind::frames; },
                                                        [](Plan& p) { p.samples = 20; },
                                                        [](Plan& p) { p.parts[1].last--; }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    Plan changed = plan_;
    changes[i](changed);
    EXPECT_NE(planId(changed), id) << i;
  }
  Plan moved = plan_;
  moved.folder = "/elsewhere";
  EXPECT_EQ(planId(moved), id);
}

TEST_F(FarmPlan, RejectsOtherFiles) {
  const std::string good = planText(plan_);
  EXPECT_EQ(errorFor(good), "");
  EXPECT_THAT(messageOf([&] { readPlan(folder_ / "none.json"); }), HasSubstr("none.json"));
  EXPECT_THAT(errorFor("{}"), HasSubstr("is not a plan"));
  EXPECT_THAT(errorFor("not JSON"), HasSubstr("is not a plan"));
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  EXPECT_THAT(errorFor(replaced("\"formatVersion\": 1", "\"formatVersion\": 2")), HasSubstr("/formatVersion"));
  EXPECT_THAT(errorFor(replaced("\"samples\": 16", "\"samples\": 20")), HasSubstr("id does not match"));
  EXPECT_THAT(errorFor(replaced("\"samples\": 16", "\"samples\": \"many\"")), HasSubstr("wrong type"));
  EXPECT_THAT(errorFor(replaced("\"samples\": 16,", "")), HasSubstr("missing"));
  EXPECT_THAT(errorFor(replaced("[1,1]", "[3,1]")), HasSubstr("/parts/1"));
  EXPECT_THAT(errorFor(replaced("[1,1]", "[0,1]")), HasSubstr("/parts/1"));
  EXPECT_THAT(errorFor(replaced("\"batches\"", "\"tiles\"")), HasSubstr("/kind"));
}

TEST_F(FarmPlan, VersionsAndContentMustAgree) {
  plan_.version = job::quintetVersion();
  plan_.libraryHash = shader::libraryHash().hex();
  EXPECT_EQ(messageOf([&] { requireSameVersion(plan_, "node7"); }), "");
  Plan other = plan_;
  other.version = "0.0.9";
  EXPECT_THROW(requireSameVersion(other, "node7"), VersionError);
  EXPECT_THAT(messageOf([&] { requireSameVersion(other, "node7"); }), AllOf(HasSubstr("0.0.9"), HasSubstr("node7")));
  other = plan_;
  other.libraryHash = std::string(32, '0');
  EXPECT_THROW(requireSameVersion(other, "node7"), VersionError);
  const auto content = [&](const char* scene, const char* environment, const char* program) {
    return messageOf([&] {
      requireSameContent(plan_, scene ? scene : plan_.sceneHash, environment ? environment : plan_.environmentHash,
                         program ? program : plan_.programHash);
    });
  };
  EXPECT_EQ(content(nullptr, nullptr, nullptr), "");
  EXPECT_THAT(content("x", nullptr, nullptr), HasSubstr("content changed"));
  EXPECT_THAT(content(nullptr, "x", nullptr), HasSubstr("environment changed"));
  EXPECT_THAT(content(nullptr, nullptr, "x"), HasSubstr("program changed"));
}

TEST_F(FarmPlan, KeepsADifferentPlan) {
  writePlan(plan_, {.program = "quintet"}, false);
  writePlan(plan_, {.program = "quintet"}, false);  // the same one again
  Plan other = plan_;
  other.samples = 15;
  EXPECT_THAT(messageOf([&] { writePlan(other, {.program = "quintet"}, false); }), HasSubstr("is a different plan"));
  EXPECT_EQ(planId(readPlan(folder_.path())), planId(plan_));
  writePlan(other, {.program = "quintet"}, true);
  EXPECT_EQ(planId(readPlan(folder_.path())), planId(other));
}

TEST_F(FarmPlan, NamesSamplesAndFiles) {
  EXPECT_EQ(partName(plan_, 2), "part 2 (batches 2–3)");
  EXPECT_EQ(partName(plan_, 0), "part 0 (batch 0)");
  plan_.samples = 15;  // the last batch has 3 samples
  EXPECT_EQ(samplesOf(plan_, 2), (render::SampleRange{8, 15}));
  plan_.parts = splitWork(0, 4999, 5000, "batch", "batches");
  EXPECT_EQ(partFile(plan_, 4321), folder_ / "parts/004/004321.qfilm");
  EXPECT_EQ(planFolders(plan_).size(), 1u + 5u);
}

std::string scriptOf(const Plan& plan, const ScriptOptions& options, const std::string& name) {
  for (const auto& [file, text] : scripts(plan, options))
    if (file == name) return text;
  return "";
}

TEST_F(FarmPlan, ScriptsStayWithinTheLargestArray) {
  plan_.parts = splitWork(0, 99'999, 100'000, "batch", "batches");
  const ScriptOptions options{.program = "/opt/my quintet",
                              .tasks = 1000,
                              .partition = "gpu",
                              .time = "2:00:00",
                              .memory = "16G",
                              .sbatch = {"--gres=gpu:1"}};
  const std::string render = scriptOf(plan_, options, "render.sbatch");
  for (const char* text :
       {"#SBATCH --array=0-999\n", "part < 100000; part += 1000", "'/opt/my quintet'", "#SBATCH --requeue\n",
        "#SBATCH --partition=gpu\n", "#SBATCH --time=2:00:00\n", "#SBATCH --mem=16G\n", "#SBATCH --gres=gpu:1\n"})
    EXPECT_THAT(render, HasSubstr(text));
  EXPECT_THAT(scriptOf(plan_, options, "merge.sbatch"), HasSubstr("farm merge"));
  EXPECT_THAT(scriptOf(plan_, options, "submit.sh"), HasSubstr("afterany"));
  EXPECT_THAT(scriptOf(plan_, options, "parallel.sh"), HasSubstr("seq 0 99999"));
  EXPECT_THAT(messageOf([&] { scripts(plan_, {.program = "q", .sbatch = {"--a\n#SBATCH --b"}}); }),
              HasSubstr("line break"));
}

// Runs the script of the plan in bash, where `programs` has these programs besides those of the system.
int runScript(const Plan& plan, const std::string& name, const std::string& arguments,
              const std::filesystem::path& programs) {
  const std::string command =
      fmt::format("PATH={}:$PATH bash {} {} > {} 2>&1", shellQuoted(programs.string()),
                  shellQuoted((plan.folder / name).string()), arguments, shellQuoted((programs / "output").string()));
  return std::system(command.c_str());
}

// The scripts of a plan whose program and folder have names that shells, sbatch and GNU parallel could change.
class FarmScripts : public testing::Test {
 protected:
  FarmScripts() {
    std::filesystem::create_directories(bin_);
    options_.program = bin_ / "the quintet's";
    // One write of a whole line, because parts run at the same time.
    program("the quintet's", "line=$(printf '%s|' \"$@\"); echo \"$line\" >> \"$(dirname \"$0\")/calls\"");
    writePlan(plan_, options_, false);
  }
  void program(const std::string& name, const std::string& text) const {
    writeFile(bin_ / name, "#!/usr/bin/env bash\n" + text + "\n");
    std::filesystem::permissions(bin_ / name, std::filesystem::perms(0755));
  }
  // Sorted, because parts run at the same time.
  std::vector<std::string> calls() const {
    std::vector<std::string> lines = splitText(readTextFile(bin_ / "calls"), '\n');
    lines.pop_back();
    std::ranges::sort(lines);
    return lines;
  }
  std::vector<std::string> expectedCalls() const {
    const std::string file = (plan_.folder / kPlanFile).string();
    return {"farm|merge|" + file + "|", "farm|run|--quiet|" + file + "|0|", "farm|run|--quiet|" + file + "|1|"};
  }

  const quintet::test::TempFolder folder_;
  const std::filesystem::path bin_ = folder_ / "bin";
  const Plan plan_ = test::makePlan(folder_ / "it's a \"farm\" {1} $HOME `x` \\ & ü", 2);
  ScriptOptions options_;
};

TEST_F(FarmScripts, OfSlurmWorkInFoldersWithAnyName) {
  // Runs the tasks of the array, and prints the options of the script as sbatch reads them.
  program("sbatch", R"(shift $(($# - 1))
grep '^#SBATCH' "$1" | while read -r _ option; do eval "printf '<%s>\n' $option"; done > "options.$1"
if [[ $1 == render.sbatch ]]; then SLURM_ARRAY_TASK_ID=0 bash "$1"; SLURM_ARRAY_TASK_ID=1 bash "$1"; else bash "$1"; fi
echo 7)");
  options_.sbatch = {"--comment=it's \"one\" # of \\ two", "--gres=gpu:1"};
  writePlan(plan_, options_, false);
  ASSERT_EQ(runScript(plan_, "submit.sh", "", bin_), 0) << readTextFile(bin_ / "output");
  EXPECT_EQ(calls(), expectedCalls());
  EXPECT_THAT(readTextFile(plan_.folder / "options.render.sbatch"),
              testing::AllOf(HasSubstr("<--comment=it's \"one\" # of \\ two>\n"), HasSubstr("<--gres=gpu:1>\n")));
}

TEST_F(FarmScripts, OfGnuParallelWorkInFoldersWithAnyName) {
  if (std::system("command -v parallel > /dev/null") != 0) GTEST_SKIP() << "GNU parallel is not installed";
  ASSERT_EQ(runScript(plan_, "parallel.sh", "--jobs 2", bin_), 0) << readTextFile(bin_ / "output");
  EXPECT_EQ(calls(), expectedCalls());
}

}  // namespace
}  // namespace quintet::farm
