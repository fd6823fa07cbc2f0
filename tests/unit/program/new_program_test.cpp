// SPDX-License-Identifier: Apache-2.0
// New programs: templates, copies under a new name, and what createProgram refuses to overwrite.
#include "program/new_program.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "base/file.h"
#include "program/load.h"
#include "temp_folder.h"

namespace quintet::program {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> namesOf(const NewProgram& program) {
  std::vector<std::string> names;
  for (const auto& [name, text] : program.files) names.push_back(name);
  return names;
}

TEST(NewProgram, PlansOneFileOrAFolder) {
  for (const char* name : {"a/first", "a/first.rt.glsl"}) {
    const NewProgram file = planNewProgram({.name = name, .from = "", .folder = false});
    EXPECT_EQ(file.program, fs::path("a/first.rt.glsl"));
    EXPECT_EQ(file.folder, fs::path("a"));
    EXPECT_THAT(namesOf(file), ElementsAre("first.rt.glsl"));
  }
  const NewProgram folder = planNewProgram({.name = "a/first/", .from = "", .folder = true});
  EXPECT_EQ(folder.program, fs::path("a/first"));
  EXPECT_EQ(folder.folder, folder.program);
  EXPECT_TRUE(folder.files.contains("program.toml"));
}

TEST(NewProgram, RejectsUnusableNames) {
  for (const char* name : {"", ".", "..", "a/..", ".rt.glsl"})
    EXPECT_THROW(planNewProgram({.name = name, .from = "", .folder = false}), UsageError) << name;
  EXPECT_THROW(planNewProgram({.name = "x", .from = "pathtracr", .folder = false}), UsageError);
}

TEST(NewProgram, TemplatesCanBeLoaded) {
  const test::TempFolder folder;
  for (const bool asFolder : {false, true}) {
    const std::string name = (folder.path() / (asFolder ? "folder" : "file")).string();
    createProgram(planNewProgram({.name = name, .from = "", .folder = asFolder}));
    const Program program = loadProgram(name);
    EXPECT_TRUE(program.diagnostics.empty());
    EXPECT_FALSE(program.description.empty());
    EXPECT_FALSE(program.parameters.empty());
  }
}

TEST(NewProgram, CopiesFolders) {
  const NewProgram copy = planNewProgram({.name = "mine", .from = "ao", .folder = false});
  EXPECT_EQ(copy.program, fs::path("mine"));
  EXPECT_EQ(copy.files, loadProgram("ao").files);
}

TEST(NewProgram, CopiesLecturesWithTheirSceneUnderTheNewName) {
  const NewProgram copy = planNewProgram({.name = "mine", .from = "lessons/01_first_ray", .folder = false});
  EXPECT_EQ(copy.program, fs::path("mine.rt.glsl"));
  EXPECT_THAT(namesOf(copy), ElementsAre("mine.rt.glsl", "mine.scene.toml"));
  EXPECT_THAT(copy.files.at("mine.rt.glsl"), HasSubstr("scene: mine.scene.toml"));
  const NewProgram inFolder = planNewProgram({.name = "a/mine", .from = "lessons/01_first_ray", .folder = true});
  EXPECT_EQ(inFolder.program, fs::path("a/mine/mine.rt.glsl"));
}

TEST(NewProgram, CopiesTheFilesThatALectureMentions) {
  const test::TempFolder folder;
  const auto write = [&](const char* name, std::string_view text) { writeFile(folder.path() / name, text); };
  write("one.rt.glsl", "#include \"a.glsl\"\nvoid main() { /**** RAY GENERATION SHADER ****/ }\n");
  write("a.glsl", "#include \"b.glsl\"\n");
  write("b.glsl", "const int kB = 1;\n");
  write("c.glsl", "const int kC = 1;\n");
  const NewProgram copy =
      planNewProgram({.name = "two", .from = (folder.path() / "one.rt.glsl").string(), .folder = false});
  EXPECT_THAT(namesOf(copy), ElementsAre("a.glsl", "b.glsl", "two.rt.glsl"));
}

TEST(NewProgram, OverwritesNothing) {
  const test::TempFolder folder;
  const std::string name = (folder.path() / "one").string();
  const NewProgram file = planNewProgram({.name = name, .from = "", .folder = false});
  createProgram(file);
  EXPECT_THROW(createProgram(file), FileError);
  // A folder of this name would hide the file from `quintet run`.
  const NewProgram other = planNewProgram({.name = (folder.path() / "two").string(), .from = "", .folder = false});
  fs::create_directory(folder.path() / "two");
  EXPECT_THROW(createProgram(other), FileError);
  EXPECT_FALSE(fs::exists(other.program));
  EXPECT_THROW(createProgram(planNewProgram({.name = name + ".rt.glsl/x/y", .from = "", .folder = true})), FileError);
}

}  // namespace
}  // namespace quintet::program
