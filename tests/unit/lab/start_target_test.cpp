// SPDX-License-Identifier: Apache-2.0
#include "lab/start_target.h"

#include <filesystem>

#include <gmock/gmock.h>

#include "base/error.h"
#include "base/file.h"
#include "temp_folder.h"

namespace quintet::lab {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr const char* kLecture = "void main() { /**** RAY GENERATION SHADER ****/ }\n";

TEST(StartTarget, WithoutAnArgumentShowsTheFirstLesson) {
  EXPECT_EQ(chooseStart("").folder, kDefaultFolder);
  EXPECT_EQ(chooseStart("").program, kDefaultProgram);
}

TEST(StartTarget, ShowsABuiltInProgramByAnyOfItsNames) {
  for (const char* name : {"lessons/05_shadow", "05_shadow", "shadow", "<programs/lessons/05_shadow>"}) {
    EXPECT_EQ(chooseStart(name).folder, kDefaultFolder);
    EXPECT_EQ(chooseStart(name).program, "<programs/lessons/05_shadow>") << name;
  }
  EXPECT_THROW(chooseStart("shadw"), UsageError);
}

TEST(StartTarget, AFileGivesAccessToWhatItNames) {
  const test::TempFolder folder;
  writeFile(folder / "a.rt.glsl", kLecture);
  writeFile(folder / "b.rt.glsl", kLecture);
  writeFile(folder / "fox.glb", "");
  for (const char* name : {"b", "b.rt.glsl"}) {
    const StartTarget target = chooseStart((folder / name).string());
    EXPECT_EQ(target.folder, folder.path());
    EXPECT_EQ(target.program, "b.rt.glsl");
    EXPECT_EQ(target.scene, "");
    EXPECT_THAT(target.files, ElementsAre("b.rt.glsl"));
  }
  const StartTarget scene = chooseStart((folder / "fox.glb").string());
  EXPECT_EQ(scene.folder, folder.path());
  EXPECT_EQ(scene.program, "<programs/pathtracer>");
  EXPECT_EQ(scene.scene, "fox.glb");
  EXPECT_THAT(scene.files, ElementsAre("fox.glb"));
  EXPECT_THROW(chooseStart((folder / "none.glb").string()), FileError);
}

TEST(StartTarget, AFolderIsTheProject) {
  const test::TempFolder folder;
  EXPECT_EQ(chooseStart(folder.path().string()).program, kDefaultProgram);
  fs::create_directories(folder / "z/inner");
  writeFile(folder / "z/inner/one.rt.glsl", kLecture);
  EXPECT_EQ(chooseStart(folder.path().string()).program, "z/inner");
  writeFile(folder / "program.toml", "");
  EXPECT_EQ(chooseStart(folder.path().string()).program, "program.toml");
  EXPECT_THAT(chooseStart(folder.path().string()).files, IsEmpty()) << "all";
  EXPECT_THAT(chooseStart((folder / "program.toml").string()).files, IsEmpty());
}

}  // namespace
}  // namespace quintet::lab
