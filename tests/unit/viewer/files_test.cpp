// SPDX-License-Identifier: Apache-2.0
// Files of the viewer: what a file is for, folders, and bookmarks.
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "temp_folder.h"
#include "viewer/bookmarks.h"
#include "viewer/dropped_file.h"
#include "viewer/folder_listing.h"

namespace quintet::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

TEST(DroppedFile, IsRecognizedByItsName) {
  EXPECT_EQ(useOfFile("a.glb"), FileUse::scene);
  EXPECT_EQ(useOfFile("/x/A.GLTF"), FileUse::scene);
  EXPECT_EQ(useOfFile("a.scene.toml"), FileUse::scene);
  EXPECT_EQ(useOfFile("x/program.toml"), FileUse::program);
  EXPECT_EQ(useOfFile("a.rt.glsl"), FileUse::program);
  EXPECT_EQ(useOfFile("sky.hdr"), FileUse::environment);
  EXPECT_EQ(useOfFile("sky.exr"), FileUse::environment);
  EXPECT_EQ(useOfFile("a.png"), FileUse::reference);
  EXPECT_EQ(useOfFile("a.jpeg"), FileUse::reference);
  EXPECT_EQ(useOfFile("pixel.json"), FileUse::explanation);
  EXPECT_EQ(useOfFile("a.glsl"), FileUse::unknown);
  EXPECT_EQ(useOfFile("other.toml"), FileUse::unknown);
  EXPECT_EQ(useOfFile(""), FileUse::unknown);
}

TEST(DroppedFile, CanBeTheFolderOfAProgram) {
  const test::TempFolder folder;
  for (const char* name : {"a", "b", "c"}) std::filesystem::create_directory(folder / name);
  writeFile(folder / "a/program.toml", "");
  writeFile(folder / "b/main.rt.glsl", "");
  writeFile(folder / "c/main.glsl", "");
  EXPECT_EQ(useOfFile(folder / "a"), FileUse::program);
  EXPECT_EQ(useOfFile(folder / "b"), FileUse::program);
  EXPECT_EQ(useOfFile(folder / "c"), FileUse::unknown);
}

TEST(FolderListing, HasWhatCanBeOpened) {
  const test::TempFolder folder;
  for (const char* name : {"Zebra", "alpha", "program", ".hidden"}) std::filesystem::create_directory(folder / name);
  writeFile(folder / "program/program.toml", "");
  for (const char* name : {"b.glb", "A.hdr", "notes.txt", ".c.glb"}) writeFile(folder / name, "");
  std::vector<std::string> names;
  for (const FolderEntry& entry : listFolder(folder.path()))
    names.push_back(entry.name + (entry.folder ? "/" : "") + (entry.use == FileUse::program ? " program" : ""));
  EXPECT_THAT(names, ElementsAre("alpha/", "program/ program", "Zebra/", "A.hdr", "b.glb"));
}

TEST(FolderListing, ReportsMissingFolders) {
  EXPECT_THAT([] { listFolder("/missing/folder"); }, ThrowsMessage<FileError>(HasSubstr("/missing/folder")));
}

TEST(Bookmarks, SurviveTheFile) {
  const test::TempFolder folder;
  const std::filesystem::path file = folder / "config/bookmarks.json";
  EXPECT_THAT(Bookmarks::read(file).of("/a.glb"), IsEmpty());
  Bookmarks bookmarks;
  job::CameraRequest camera;
  camera.lookFrom = vec3(1, 2, 3);
  camera.lookAt = vec3(0.1f, 0, -1e-7f);
  camera.up = {0, 0, 1};
  camera.verticalFov = 35.0f;
  camera.apertureRadius = 0.01f;
  camera.focusDistance = 2.5f;
  EXPECT_EQ(bookmarks.add("/a.glb", camera), "Bookmark 1");
  EXPECT_EQ(bookmarks.add("/a.glb", {.name = "front"}), "Bookmark 2");
  EXPECT_EQ(bookmarks.add("/b.glb", {}), "Bookmark 1");
  bookmarks.write(file);
  const Bookmarks read = Bookmarks::read(file);
  ASSERT_EQ(read.of("/a.glb").size(), 2u);
  EXPECT_EQ(read.of("/a.glb")[0].camera, camera);
  EXPECT_EQ(read.of("/a.glb")[1].camera, (job::CameraRequest{.name = "front"}));
  EXPECT_EQ(read.of("/b.glb").size(), 1u);
}

TEST(Bookmarks, AreRenamedAndRemoved) {
  Bookmarks bookmarks;
  for (int i = 0; i < 3; ++i) bookmarks.add("s", {});
  bookmarks.rename("s", 1, "Side");
  bookmarks.remove("s", Bookmark(bookmarks.of("s")[0]));
  bookmarks.remove("s", {"Bookmark 1", {.name = "other camera"}});
  bookmarks.remove("t", {"Bookmark 2", {}});
  EXPECT_EQ(bookmarks.add("s", {}), "Bookmark 1") << "the first free number";
  std::vector<std::string> names;
  for (const Bookmark& bookmark : bookmarks.of("s")) names.push_back(bookmark.name);
  EXPECT_THAT(names, ElementsAre("Side", "Bookmark 3", "Bookmark 1"));
}

TEST(Bookmarks, RejectOtherFiles) {
  const test::TempFolder folder;
  for (const char* text : {"{", R"({"a": [{"up": [0, 1, 0]}]})", R"({"a": [{"name": "x", "up": [0, 1]}]})"}) {
    writeFile(folder / "b.json", text);
    EXPECT_THAT([&] { Bookmarks::read(folder / "b.json"); }, ThrowsMessage<FileError>(HasSubstr("b.json"))) << text;
  }
}

}  // namespace
}  // namespace quintet::viewer
