// SPDX-License-Identifier: Apache-2.0
#include "lab/project_folder.h"

#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "base/file.h"
#include "temp_folder.h"

namespace quintet::lab {
namespace {

namespace fs = std::filesystem;

class ProjectFolderTest : public ::testing::Test {
 protected:
  ProjectFolderTest() {
    fs::create_directories(folder_.path() / "project" / "sub");
    fs::create_directories(folder_.path() / "outside");
    writeFile(folder_.path() / "outside" / "secret.txt", "secret");
    writeFile(folder_.path() / "project" / "a.glsl", "old");
    project_.emplace(folder_.path() / "project");
  }
  fs::path path(const std::string& name) const { return folder_.path() / "project" / name; }

  const test::TempFolder folder_;
  std::optional<ProjectFolder> project_;
};

TEST_F(ProjectFolderTest, FollowsNoLinksToHiddenFiles) {
  fs::create_directories(path(".git"));
  writeFile(path(".git/config"), "password");
  fs::create_symlink(".git/config", path("config"));
  fs::create_directory_symlink(".git", path("git"));
  fs::create_symlink("a.glsl", path("b.glsl"));
  EXPECT_THROW(project_->read("config"), NameError);
  EXPECT_THROW(project_->read("git/config"), NameError);
  EXPECT_EQ(project_->read("b.glsl"), "old");
  EXPECT_THAT(
      project_->list().files,
      ::testing::Each(::testing::Field(&ProjectFolder::Entry::name, ::testing::Not(::testing::HasSubstr("config")))));
}

TEST_F(ProjectFolderTest, CanHaveSomeFilesOfItsFolder) {
  fs::create_directories(path("lib"));
  writeFile(path("lib/x.glsl"), "x");
  writeFile(path("lib/y.glsl"), "y");
  writeFile(path("private.txt"), "private");
  const ProjectFolder project(folder_.path() / "project", {"a.glsl", "lib/x.glsl"});
  const auto names = [&] {
    std::vector<std::string> found;
    for (const ProjectFolder::Entry& entry : project.list().files) found.push_back(entry.name);
    return found;
  };
  EXPECT_THAT(names(), ::testing::ElementsAre("a.glsl", "lib/x.glsl"));
  EXPECT_EQ(project.read("lib/x.glsl"), "x");
  EXPECT_NO_THROW(project.locate("lib"));
  for (const char* name : {"private.txt", "lib/y.glsl", "sub"}) {
    EXPECT_THROW(project.read(name), NameError) << name;
    EXPECT_THROW(project.write(name, "x", {}), NameError) << name;
    EXPECT_THROW(project.remove(name, {}), NameError) << name;
  }
  project.write("new/b.glsl", "b", {.mustNotExist = true});
  EXPECT_EQ(project.read("new/b.glsl"), "b");
  EXPECT_THAT(names(), ::testing::ElementsAre("a.glsl", "lib/x.glsl", "new/b.glsl"));
  EXPECT_EQ(project.files().size(), 3u);
}

TEST_F(ProjectFolderTest, AcceptsPlainNames) {
  for (const char* name : {"a", "a.glsl", "sub/a b.toml", "größe/ä.png", "a..b/c...d"})
    EXPECT_TRUE(isFileName(name)) << name;
}

TEST_F(ProjectFolderTest, RejectsAllOtherNames) {
  for (const std::string& name :
       {std::string(), std::string("/a"), std::string("a/"), std::string("a//b"), std::string("."), std::string(".."),
        std::string("../a"), std::string("a/../b"), std::string("a/./b"), std::string(".git/config"),
        std::string("a/.hidden"), std::string("a\\b"), std::string("a\nb"), std::string("a\0b", 3),
        std::string("a\xFF"), std::string("\xC0\xAE\xC0\xAE/a"), std::string(300, 'a'), std::string(2000, '/')}) {
    EXPECT_FALSE(isFileName(name)) << name;
    EXPECT_THROW(project_->read(name), NameError) << name;
    EXPECT_THROW(project_->write(name, "x", {}), NameError) << name;
    EXPECT_THROW(project_->remove(name, {}), NameError) << name;
  }
}

TEST_F(ProjectFolderTest, FollowsLinksOnlyInside) {
  fs::create_symlink(path("a.glsl"), path("inside.glsl"));
  EXPECT_EQ(project_->read("inside.glsl"), "old");
  fs::create_symlink(folder_.path() / "outside" / "secret.txt", path("link.txt"));
  fs::create_directory_symlink(folder_.path() / "outside", path("folder"));
  fs::create_symlink(folder_.path() / "outside" / "new.txt", path("broken.txt"));
  for (const char* name : {"link.txt", "folder/secret.txt", "folder/new.txt", "broken.txt"}) {
    EXPECT_THROW(project_->read(name), NameError) << name;
    EXPECT_THROW(project_->write(name, "x", {}), NameError) << name;
    EXPECT_THROW(project_->remove(name, {}), NameError) << name;
  }
  EXPECT_EQ(readTextFile(folder_.path() / "outside" / "secret.txt"), "secret");
  EXPECT_FALSE(fs::exists(folder_.path() / "outside" / "new.txt"));
}

TEST_F(ProjectFolderTest, DoesNotWaitForPipes) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_THROW(project_->read("pipe"), FileError);
  EXPECT_THROW(project_->write("pipe", "x", {}), FileError);
}

TEST_F(ProjectFolderTest, ReplacesOnlyTheExpectedVersion) {
  const std::string old = contentHash("old");
  const auto written = project_->write("a.glsl", "new", {.hash = old});
  EXPECT_FALSE(written.created);
  EXPECT_EQ(written.hash, contentHash("new"));
  try {
    project_->write("a.glsl", "newer", {.hash = old});
    FAIL();
  } catch (const ConflictError& error) {
    EXPECT_EQ(error.hash(), contentHash("new"));
  }
  EXPECT_THROW(project_->write("a.glsl", "newer", {.mustNotExist = true}), ConflictError);
  EXPECT_THROW(project_->write("missing.glsl", "x", {.hash = old}), ConflictError);
  EXPECT_FALSE(fs::exists(path("missing.glsl")));
  EXPECT_THROW(project_->remove("a.glsl", {.hash = old}), ConflictError);
  EXPECT_EQ(readTextFile(path("a.glsl")), "new");
  project_->write("a.glsl", "last", {});
  EXPECT_EQ(readTextFile(path("a.glsl")), "last");
  project_->remove("a.glsl", {.hash = contentHash("last")});
  EXPECT_FALSE(fs::exists(path("a.glsl")));
}

TEST_F(ProjectFolderTest, CreatesFolders) {
  EXPECT_TRUE(project_->write("x/y/z.toml", "text", {.mustNotExist = true}).created);
  EXPECT_EQ(readTextFile(path("x/y/z.toml")), "text");
}

TEST_F(ProjectFolderTest, KeepsAnEqualFile) {
  const fs::file_time_type before = fs::file_time_type::clock::now() - std::chrono::hours(1);
  fs::last_write_time(path("a.glsl"), before);
  project_->write("a.glsl", "old", {});
  EXPECT_EQ(fs::last_write_time(path("a.glsl")), before);
}

TEST_F(ProjectFolderTest, ListsFilesInOrderWithoutHiddenOnes) {
  writeFile(path("sub/b.toml"), "12345");
  writeFile(path(".hidden"), "x");
  fs::create_directory(path(".git"));
  writeFile(path(".git/config"), "x");
  fs::create_symlink(folder_.path() / "outside" / "secret.txt", path("link.txt"));
  const ProjectFolder::Listing listing = project_->list();
  EXPECT_FALSE(listing.truncated);
  ASSERT_EQ(listing.files.size(), 2u);
  EXPECT_EQ(listing.files[0].name, "a.glsl");
  EXPECT_EQ(listing.files[1].name, "sub/b.toml");
  EXPECT_EQ(listing.files[1].size, 5u);
  EXPECT_GT(listing.files[1].modified, 1.5e9);
}

// The listing has the files of the project folder and of seven levels of folders below it.
TEST_F(ProjectFolderTest, ListsFilesInEightLevelsOfFolders) {
  fs::create_directories(path("1/2/3/4/5/6/7"));
  writeFile(path("1/2/3/4/5/6/7/listed.glsl"), "x");
  EXPECT_FALSE(project_->list().truncated);
  fs::create_directories(path("1/2/3/4/5/6/7/8"));
  writeFile(path("1/2/3/4/5/6/7/8/deep.glsl"), "x");
  const ProjectFolder::Listing listing = project_->list();
  EXPECT_TRUE(listing.truncated);
  ASSERT_EQ(listing.files.size(), 2u);
  EXPECT_EQ(listing.files[0].name, "1/2/3/4/5/6/7/listed.glsl");
  EXPECT_EQ(listing.files[1].name, "a.glsl");
  EXPECT_EQ(project_->read("1/2/3/4/5/6/7/8/deep.glsl"), "x") << "a name can be deeper";
}

TEST_F(ProjectFolderTest, RequiresAFolder) {
  EXPECT_THROW(ProjectFolder(path("missing")), FileError);
  EXPECT_THROW(ProjectFolder(path("a.glsl")), FileError);
}

}  // namespace
}  // namespace quintet::lab
